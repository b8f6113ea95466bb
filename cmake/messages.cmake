# Messages, services and sliders, and the exports to other catkin packages.
add_message_files(DIRECTORY msg)
# leap_motion/Human of the Leap's driver in its four versions, and leap_motion_controller/Hand: an MD5 does not depend on the package's name.
add_message_files(DIRECTORY msg/leap)
add_service_files(DIRECTORY srv)
generate_messages(DEPENDENCIES geometry_msgs std_msgs)
generate_dynamic_reconfigure_options(cfg/Tune.cfg)
# Which reads the filters' numbers there.
add_custom_command(OUTPUT ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_INCLUDE_DESTINATION}/TuneConfig.h
  APPEND DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/config/default.yaml)

set(run_packages ${ros_packages} message_runtime)
list(REMOVE_ITEM run_packages message_generation rosbag_storage)  # the latter: inside the library alone
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES ${PROJECT_NAME}_core ${PROJECT_NAME}_ros
  CATKIN_DEPENDS ${run_packages}
  DEPENDS EIGEN3
  CFG_EXTRAS ${PROJECT_NAME}-targets.cmake)
