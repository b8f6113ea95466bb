# The build without ROS: replay of CSV recordings, and a CMake package with the target ${PROJECT_NAME}::core.
file(GLOB replay_library_sources src/record/*.cpp src/replay/*.cpp src/without_ros/*.cpp)
list(FILTER replay_library_sources EXCLUDE REGEX "/src/replay/(bag|marker)_[a-z]*.cpp$")
list(APPEND replay_library_sources src/ros/package_paths.cpp)
add_library(${PROJECT_NAME}_replay STATIC ${replay_library_sources})
target_include_directories(${PROJECT_NAME}_replay PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
target_link_libraries(${PROJECT_NAME}_replay PUBLIC ${PROJECT_NAME}_core PRIVATE yaml-cpp)
# Scenes are found from where it was built, too.
set_source_files_properties(src/record/record.cpp src/replay/run.cpp PROPERTIES
  COMPILE_DEFINITIONS MR_HAND_INTERACTION_VERSION="${PROJECT_VERSION}")
set_source_files_properties(src/ros/package_paths.cpp PROPERTIES
  COMPILE_DEFINITIONS "MR_HAND_INTERACTION_SOURCE_DIR=\"${CMAKE_CURRENT_SOURCE_DIR}\";MR_HAND_INTERACTION_WITHOUT_ROS")
add_executable(replay src/nodes/replay.cpp)
target_link_libraries(replay ${PROJECT_NAME}_replay)

set_target_properties(${PROJECT_NAME}_core PROPERTIES EXPORT_NAME core)
set_target_properties(replay PROPERTIES INSTALL_RPATH "$ORIGIN/../../${CMAKE_INSTALL_LIBDIR}")
install(TARGETS ${PROJECT_NAME}_core EXPORT ${PROJECT_NAME}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS replay RUNTIME DESTINATION lib/${PROJECT_NAME})
install(PROGRAMS scripts/compare scripts/explain scripts/export DESTINATION lib/${PROJECT_NAME})
install(DIRECTORY scripts/runs scripts/study DESTINATION lib/${PROJECT_NAME} PATTERN __pycache__ EXCLUDE)
install(DIRECTORY include/${PROJECT_NAME} DESTINATION include PATTERN ros EXCLUDE PATTERN replay EXCLUDE)
install(DIRECTORY config DESTINATION share/${PROJECT_NAME})
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/${PROJECT_NAME})
install(EXPORT ${PROJECT_NAME} FILE ${PROJECT_NAME}Targets.cmake NAMESPACE ${PROJECT_NAME}:: DESTINATION ${config_folder})
include(CMakePackageConfigHelpers)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${PROJECT_NAME}Config.cmake
  "include(CMakeFindDependencyMacro)\nfind_dependency(Eigen3)\n"
  "include(\${CMAKE_CURRENT_LIST_DIR}/${PROJECT_NAME}Targets.cmake)\n")
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/${PROJECT_NAME}ConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/${PROJECT_NAME}Config.cmake ${CMAKE_CURRENT_BINARY_DIR}/${PROJECT_NAME}ConfigVersion.cmake
  DESTINATION ${config_folder})

option(BUILD_TESTING "Build the tests of the core" ON)
if(BUILD_TESTING)
  find_package(GTest)
  if(GTEST_FOUND)
    enable_testing()
    add_subdirectory(test)
  else()
    message(STATUS "googletest not found: no tests")
  endif()
endif()
