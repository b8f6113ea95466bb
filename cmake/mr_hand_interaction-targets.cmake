# Imported targets mr_hand_interaction::core and ::ros, made from the libraries that catkin found.
if(NOT TARGET mr_hand_interaction::core)
  find_package(Eigen3 3.3 REQUIRED NO_MODULE)
  foreach(library ${mr_hand_interaction_LIBRARIES})
    if(library MATCHES "mr_hand_interaction_core\\.[^/]*$")
      add_library(mr_hand_interaction::core UNKNOWN IMPORTED)
      set_target_properties(mr_hand_interaction::core PROPERTIES
        IMPORTED_LOCATION ${library}
        INTERFACE_INCLUDE_DIRECTORIES "${mr_hand_interaction_INCLUDE_DIRS}"
        INTERFACE_LINK_LIBRARIES Eigen3::Eigen)
    endif()
  endforeach()
  add_library(mr_hand_interaction::ros INTERFACE IMPORTED)
  set_target_properties(mr_hand_interaction::ros PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${mr_hand_interaction_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "mr_hand_interaction::core;${mr_hand_interaction_LIBRARIES}")
endif()
