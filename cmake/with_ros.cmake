# The ROS library, the nodes and what is installed beside them.
file(GLOB ros_sources src/record/*.cpp src/ros/*.cpp src/replay/*.cpp)
set(SANITIZED_SOURCES "" CACHE STRING "What scripts/sanitize adds to the ROS library")
add_library(${PROJECT_NAME}_ros ${ros_sources} ${SANITIZED_SOURCES})
target_include_directories(${PROJECT_NAME}_ros PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated src)
target_include_directories(${PROJECT_NAME}_ros SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(${PROJECT_NAME}_ros PUBLIC ${PROJECT_NAME}_core ${catkin_LIBRARIES} PRIVATE yaml-cpp)
precompile(${PROJECT_NAME}_ros <ros/ros.h> <visualization_msgs/MarkerArray.h>)
set_target_properties(${PROJECT_NAME}_ros PROPERTIES UNITY_BUILD ${COMPILE_TOGETHER} UNITY_BUILD_BATCH_SIZE 4)
add_dependencies(${PROJECT_NAME}_ros ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})

set_source_files_properties(src/nodes/training_node.cpp src/nodes/simulated_study.cpp src/record/record.cpp src/replay/run.cpp PROPERTIES
  COMPILE_DEFINITIONS MR_HAND_INTERACTION_VERSION="${PROJECT_VERSION}")
# Scenes are found from a devel space even where no environment has been sourced.
set_source_files_properties(src/ros/package_paths.cpp PROPERTIES
  COMPILE_DEFINITIONS MR_HAND_INTERACTION_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}")

set(nodes hand_interaction_node hand_tracking_node interaction_node synthetic_hand_node training_node replay
  merge_hands simulated_operator_node simulated_study check_scene)
foreach(node ${nodes})
  add_executable(${node} src/nodes/${node}.cpp)
  target_link_libraries(${node} ${PROJECT_NAME}_ros)
  precompiled_as(${node} ${PROJECT_NAME}_ros)
endforeach()

install(TARGETS ${PROJECT_NAME}_core ${PROJECT_NAME}_ros
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(TARGETS ${nodes} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
# No relays in the devel space: where that lies in the package, as after scripts/demo, rosrun would find both and ask.
set(scripts analyse_study ask_participant ask_ratings calibrate_mount calibrate_study compare doctor explain export import_captures
  leapc_bridge mediapipe_bridge plan_study power_study run_when set training_keys web_door)
foreach(script ${scripts})
  install(PROGRAMS scripts/${script} DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  file(REMOVE ${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME}/${script})  # of an earlier build
endforeach()
# Programs that draw rviz on a virtual screen; `setup` is sourced by them.
install(PROGRAMS scripts/film scripts/screenshot DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES scripts/setup scripts/virtual_screen DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(PROGRAMS scripts/explain_pictures.py scripts/film.py scripts/free_port.py scripts/rviz_stage.py scripts/screenshot.py scripts/watch_demo.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY scripts/captures scripts/runs scripts/study scripts/web DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} PATTERN __pycache__ EXCLUDE)
include(cmake/rviz.cmake)
install(FILES rviz_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(DIRECTORY config launch rviz web DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
