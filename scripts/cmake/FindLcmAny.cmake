# LCM, whichever way it is installed: Debian 12's liblcm-dev 1.3.1 has no CMake config (and its lcm.pc fails
# without libglib2.0-dev); upstream has one since 1.4. Provides LcmAny::lcm and LCM_GEN.
find_package(lcm CONFIG QUIET)
if(lcm_FOUND)
  add_library(LcmAny::lcm INTERFACE IMPORTED)
  target_link_libraries(LcmAny::lcm INTERFACE lcm)
  find_program(LCM_GEN lcm-gen REQUIRED)
  set(LcmAny_FOUND TRUE)
else()
  find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp)
  find_library(LCM_LIBRARY lcm)
  find_program(LCM_GEN lcm-gen)
  include(FindPackageHandleStandardArgs)
  find_package_handle_standard_args(LcmAny REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR LCM_GEN)
  add_library(LcmAny::lcm UNKNOWN IMPORTED)
  set_target_properties(LcmAny::lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
