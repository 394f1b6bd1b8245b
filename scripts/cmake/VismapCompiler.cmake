# Language level, warnings and sanitizers of our own targets. Everything is on the interface target
# vismap_compiler, so that generated code (LCM, protobuf) can opt out of -Werror.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache keeps results of compiling with precompiled headers only if it is told that it may.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()

# The same map bit for bit on every machine: no fused multiply-add that one build has and another has not.
add_compile_options(-ffp-contract=off)

# A program loads only the libraries that it uses: OpenCV's image codecs alone bring a hundred, and 30 MB.
add_link_options(-Wl,--as-needed)

if(VISMAP_SANITIZE)
  add_compile_options(-fsanitize=${VISMAP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -O1 -g1)
  add_link_options(-fsanitize=${VISMAP_SANITIZE})
endif()

add_library(vismap_compiler INTERFACE)
# What these three say about std::string + const char* is wrong in GCC 12 (bugs 105651 and 105329).
target_compile_options(vismap_compiler INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-restrict
                       -Wno-stringop-overflow -Wno-array-bounds -Werror)
if(VISMAP_SANITIZE)
  # Instrumented code makes GCC see ghosts, in <regex> for one.
  target_compile_options(vismap_compiler INTERFACE -Wno-maybe-uninitialized)
endif()
