# Less work for the compiler: headers that many sources read are compiled once, and the sources of a room are compiled
# together. -DVISMAP_FAST_BUILD=OFF compiles every source by itself, as after a missing #include one has to.
option(VISMAP_FAST_BUILD "Precompiled headers, and the sources of a room compiled together" ON)

# vismap_cold(TARGET): little time is spent in this code: reading options and files, waiting for messages. With -O1, GCC
# needs two thirds of the time for it. Results do not depend on the level of optimisation.
function(vismap_cold TARGET)
  # GCC 12 with -O1 takes temporary objects for uninitialized.
  target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1> -Wno-uninitialized -Wno-maybe-uninitialized)
endfunction()

# vismap_pch(NAME [COLD] LINK libraries...): the target vismap_pch_NAME, which compiles scripts/cmake/pch/NAME.h. GCC
# takes the level of optimisation from a precompiled header, so that one for COLD code serves no other code.
function(vismap_pch NAME)
  cmake_parse_arguments(ARG "COLD" "" "LINK" ${ARGN})
  set(SOURCE ${PROJECT_BINARY_DIR}/pch/${NAME}.cc)
  file(CONFIGURE OUTPUT ${SOURCE} CONTENT "// Only here so that a target has the precompiled header.\n")
  add_library(vismap_pch_${NAME} OBJECT EXCLUDE_FROM_ALL ${SOURCE})
  target_link_libraries(vismap_pch_${NAME} PRIVATE vismap_compiler ${ARG_LINK})
  target_precompile_headers(vismap_pch_${NAME} PRIVATE ${PROJECT_SOURCE_DIR}/scripts/cmake/pch/${NAME}.h)
  if(ARG_COLD)
    vismap_cold(vismap_pch_${NAME})
  endif()
endfunction()

# vismap_use_pch(TARGET PCH): the sources of the target read the precompiled header PCH.
function(vismap_use_pch TARGET PCH)
  if(NOT VISMAP_FAST_BUILD)
    return()
  endif()
  target_compile_options(${TARGET} PRIVATE -fpch-preprocess)  # so that ccache sees the precompiled header
  target_precompile_headers(${TARGET} REUSE_FROM vismap_pch_${PCH})
  get_target_property(TYPE ${TARGET} TYPE)
  if(TYPE STREQUAL EXECUTABLE)
    target_compile_options(${TARGET} PRIVATE -fPIC)  # as the precompiled header, which libraries share
  endif()
endfunction()

# vismap_compile_together(TARGET): the sources of the target are compiled sixteen at a time. What they keep to themselves
# in an unnamed namespace must not have one name in two of them.
function(vismap_compile_together TARGET)
  set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ${VISMAP_FAST_BUILD} UNITY_BUILD_BATCH_SIZE 16)
endfunction()

# vismap_kernels(FILES...): lets the loops of these sources vectorise: neither errno nor floating-point traps are looked
# at, which changes no result. They are compiled each by itself.
function(vismap_kernels)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-fno-math-errno;-fno-trapping-math"
                              SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
endfunction()
