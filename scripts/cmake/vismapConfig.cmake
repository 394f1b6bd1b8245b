# find_package(vismap): target vismap::lcmtypes, the message types with LCM.
include(CMakeFindDependencyMacro)
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
find_dependency(LcmAny)
list(POP_BACK CMAKE_MODULE_PATH)
include(${CMAKE_CURRENT_LIST_DIR}/vismapTargets.cmake)
# The .lcm files, for lcm-gen in other languages.
get_filename_component(vismap_LCMTYPES_DIR ${CMAKE_CURRENT_LIST_DIR}/../../vismap/lcmtypes ABSOLUTE)
