# Compiles headers that most files of a target include once for all of them: half of a build is parsing Eigen, ROS and
# googletest. Files include what they use all the same, and build with this off, too.
set(precompiled_default ON)
if(CMAKE_VERSION VERSION_LESS 3.16)
  set(precompiled_default OFF)
endif()
option(PRECOMPILED_HEADERS "Compile common headers once; needs CMake 3.16" ${precompiled_default})

# precompile(TARGET [HEADER...]): a separate target compiles the headers, and TARGET includes them by one flag for all its files.
# CMake's own flags are set for each file, in one list that every object depends on: a new file would rebuild all others.
function(precompile target)
  if(NOT PRECOMPILED_HEADERS)
    return()
  endif()
  set(owner ${target}_precompiled)
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/${owner}.cpp)
  if(NOT EXISTS ${empty})
    file(WRITE ${empty} "")
  endif()
  add_library(${owner} OBJECT EXCLUDE_FROM_ALL ${empty})
  foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS COMPILE_OPTIONS)
    set_property(TARGET ${owner} PROPERTY ${property} $<TARGET_PROPERTY:${target},${property}>)
  endforeach()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY)
    set_property(TARGET ${owner} PROPERTY POSITION_INDEPENDENT_CODE ON)
  endif()
  target_precompile_headers(${owner} PRIVATE
    <algorithm> <array> <cmath> <functional> <memory> <optional> <stdexcept> <string> <vector> <Eigen/Core> <Eigen/Geometry>
    ${ARGN})
  set_property(TARGET ${target} PROPERTY PRECOMPILED_AS
    ${owner} ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${owner}.dir/cmake_pch.hxx)
  precompiled_as(${target} ${target})
endfunction()

# precompiled_as(TARGET FROM): TARGET shares the precompiled headers of FROM; both need the same compile options.
function(precompiled_as target from)
  if(PRECOMPILED_HEADERS)
    get_target_property(precompiled ${from} PRECOMPILED_AS)
    list(GET precompiled 0 owner)
    list(GET precompiled 1 header)
    add_dependencies(${target} ${owner})
    get_target_property(position_independent ${owner} POSITION_INDEPENDENT_CODE)
    if(position_independent)
      target_compile_options(${target} PRIVATE -fPIC)  # also a program of its own: gcc refuses headers that differ in this
    endif()
    set_property(TARGET ${target} APPEND_STRING PROPERTY COMPILE_FLAGS " -Winvalid-pch -include ${header}")
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources EXCLUDE REGEX "TARGET_OBJECTS")
    list(LENGTH sources count)
    foreach(number RANGE ${count})  # those of UNITY_BUILD, which have no properties of the sources in them
      list(APPEND sources ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${number}_cxx.cxx)
    endforeach()
    set_property(SOURCE ${sources} APPEND PROPERTY OBJECT_DEPENDS ${header}${CMAKE_PCH_EXTENSION})
  endif()
endfunction()
