# cmake -DHEADERS=a.hpp,b.hpp -P GuardLcmTypes.cmake
# Bounds every length that the code of lcm-gen decodes by the bytes that are left (lcmtypes/lcm_guard.h says why).
# Stops the build when the patterns do not cover a header: another lcm-gen then needs another script.

function(guard_header FILE)
  file(READ ${FILE} TEXT)
  if(TEXT MATCHES "vismap_lcm_guard")
    return()
  endif()
  string(REGEX REPLACE "(this->[A-Za-z0-9_]+(\\[ *[a-z0-9]+ *\\])*)\\.resize\\(([^;\n]*)\\);"
         "if(!vismap_lcm_guard::Fits<std::remove_reference_t<decltype(\\1)>>(\\3, maxlen - pos)) return -1; \\1.resize(\\3);"
         TEXT "${TEXT}")
  string(REGEX REPLACE "if\\((__[A-Za-z0-9_]+_len_*) > maxlen - pos\\) return -1;"
         "if(!vismap_lcm_guard::IsString((const char*)buf + offset + pos, \\1, maxlen - pos)) return -1;"
         TEXT "${TEXT}")
  string(REPLACE "#include <lcm/lcm_coretypes.h>" "#include <lcm/lcm_coretypes.h>\n#include \"lcm_guard.h\""
         TEXT "${TEXT}")
  foreach(PAIR "[.]resize[(]|guard::Fits" "[.]assign[(]|guard::IsString")
    string(REPLACE "|" ";" PAIR "${PAIR}")
    list(GET PAIR 0 USE)
    list(GET PAIR 1 GUARD)
    string(REGEX MATCHALL "${USE}" USES "${TEXT}")
    string(REGEX MATCHALL "${GUARD}" GUARDS "${TEXT}")
    list(LENGTH USES USE_COUNT)
    list(LENGTH GUARDS GUARD_COUNT)
    if(NOT USE_COUNT EQUAL GUARD_COUNT)
      message(FATAL_ERROR "GuardLcmTypes: ${FILE} decodes ${USE_COUNT} lengths ('${USE}') but ${GUARD_COUNT} could be "
              "guarded; this lcm-gen writes other code than 1.3.1: adapt scripts/cmake/GuardLcmTypes.cmake")
    endif()
  endforeach()
  if(NOT TEXT MATCHES "lcm_guard.h" OR NOT TEXT MATCHES "_decodeNoHash")
    message(FATAL_ERROR "GuardLcmTypes: ${FILE} does not look like a header of lcm-gen")
  endif()
  file(WRITE ${FILE} "${TEXT}")
endfunction()

string(REPLACE "," ";" HEADERS "${HEADERS}")
foreach(HEADER ${HEADERS})
  guard_header(${HEADER})
endforeach()
