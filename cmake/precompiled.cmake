# What most files of a target include is read once for all of them: half of the time of a build is reading Eigen, ROS and
# googletest. Files do include what they use, and build with this off, too.
set(precompiled_default ON)
if(CMAKE_VERSION VERSION_LESS 3.16)
  set(precompiled_default OFF)
endif()
option(PRECOMPILED_HEADERS "Read headers that most files include once; needs CMake 3.16" ${precompiled_default})

function(precompile target)
  if(PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE
      <algorithm> <array> <cmath> <functional> <memory> <optional> <stdexcept> <string> <vector> <Eigen/Core> <Eigen/Geometry>
      ${ARGN})
  endif()
endfunction()

# For targets of the same options: what `from` has read.
function(precompiled_as target from)
  if(PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${from})
  endif()
endfunction()
