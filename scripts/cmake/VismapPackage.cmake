# What a robot computer (component runtime, with its deployment files in component deploy), a computer that builds
# other programs for our bus (component dev), and programs in Python (component python) get; and Debian packages of them:
# scripts/package.
include(GNUInstallDirs)
set(DEPLOY ${PROJECT_SOURCE_DIR}/config/deploy)
set(SHARE ${CMAKE_INSTALL_DATADIR}/vismap)
# Where Debian has the libraries of this kind of computer.
set(LIBRARIES lib)
if(CMAKE_LIBRARY_ARCHITECTURE)
  set(LIBRARIES lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
set(DOC ${CMAKE_INSTALL_DATADIR}/doc)

# Presets and tools, beside the programs that vismap_process() installs.
file(GLOB PRESETS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/*.txtpb)
install(FILES ${PRESETS} DESTINATION ${SHARE}/config COMPONENT runtime)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/launch DESTINATION ${SHARE} COMPONENT runtime)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/launch ${PROJECT_SOURCE_DIR}/scripts/deploy-check
        DESTINATION ${SHARE}/scripts COMPONENT runtime)
install(FILES ${PROJECT_SOURCE_DIR}/scripts/procman_config.py DESTINATION ${SHARE}/scripts COMPONENT runtime)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/links)
foreach(TOOL launch deploy-check)
  file(CREATE_LINK ../share/vismap/scripts/${TOOL} ${PROJECT_BINARY_DIR}/links/vismap-${TOOL} SYMBOLIC)
  install(FILES ${PROJECT_BINARY_DIR}/links/vismap-${TOOL} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
endforeach()

# The page of vismap-viewer, when scripts/page has built it, with the licences of what is in it.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/build/page DESTINATION ${SHARE} COMPONENT runtime OPTIONAL)

# Deployment: belongs in fixed places of the system, so only packages have it.
install(DIRECTORY ${DEPLOY}/systemd/ DESTINATION lib/systemd/system COMPONENT deploy)
install(DIRECTORY ${DEPLOY}/etc/ DESTINATION /etc/vismap COMPONENT deploy)
install(DIRECTORY ${DEPLOY}/three-computers ${DEPLOY}/sysctl ${DEPLOY}/firewall
        DESTINATION ${DOC}/vismap/examples COMPONENT deploy)
install(FILES ${PROJECT_SOURCE_DIR}/procs/adapter/dimos_module.py DESTINATION ${DOC}/vismap/examples COMPONENT deploy)
# The documents keep their folders, so that the links between them work.
file(GLOB DOCUMENTS CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/*.md
     ${PROJECT_SOURCE_DIR}/config/*.md ${PROJECT_SOURCE_DIR}/libs/*.md ${PROJECT_SOURCE_DIR}/libs/python/*.md ${PROJECT_SOURCE_DIR}/procs/*.md
     ${PROJECT_SOURCE_DIR}/tests/*.md)
foreach(DOCUMENT ${DOCUMENTS})
  get_filename_component(FOLDER ${DOCUMENT} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${DOCUMENT} DESTINATION ${DOC}/vismap/${FOLDER} COMPONENT deploy)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/.readme DESTINATION ${DOC}/vismap COMPONENT deploy)

# The Python package, with the texts that it reads, where Debian's Python finds it.
set(PYTHON_PACKAGE lib/python3/dist-packages/vismap)
file(GLOB LCM_TEXTS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lcmtypes/*.lcm)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/libs/python/vismap/ DESTINATION ${PYTHON_PACKAGE} COMPONENT python
        FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
install(FILES ${LCM_TEXTS} DESTINATION ${PYTHON_PACKAGE}/lcmtypes COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/lcmtypes/older DESTINATION ${PYTHON_PACKAGE}/lcmtypes COMPONENT python OPTIONAL)
install(FILES ${PROJECT_SOURCE_DIR}/libs/mapfile/map.proto DESTINATION ${PYTHON_PACKAGE} COMPONENT python)
file(WRITE ${PROJECT_BINARY_DIR}/python/version.txt "${PROJECT_VERSION}\n")
install(FILES ${PROJECT_BINARY_DIR}/python/version.txt DESTINATION ${PYTHON_PACKAGE} COMPONENT python)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/procs/examples/camera_driver.py DESTINATION ${DOC}/python3-vismap/examples
        COMPONENT python)

# Debian's own files of documentation.
configure_file(${CMAKE_CURRENT_LIST_DIR}/deb/changelog.in ${PROJECT_BINARY_DIR}/deb/changelog @ONLY)
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/deb/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(PACKAGE_COMPONENT vismap:deploy libvismap-client${PROJECT_VERSION_MAJOR}:client vismap-dev:dev
        python3-vismap:python)
  string(REPLACE ":" ";" PAIR ${PACKAGE_COMPONENT})
  list(GET PAIR 0 PACKAGE)
  list(GET PAIR 1 COMPONENT)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${DOC}/${PACKAGE} RENAME copyright COMPONENT ${COMPONENT})
  install(FILES ${PROJECT_BINARY_DIR}/deb/changelog.gz DESTINATION ${DOC}/${PACKAGE} COMPONENT ${COMPONENT})
endforeach()

# For other programs on our bus: find_package(vismap) gives vismap::lcmtypes and vismap::client, pkg-config the same as
# "vismap" and "vismap-client".
install(TARGETS vismap_lcmtypes EXPORT vismapTargets)
install(TARGETS vismap_client EXPORT vismapTargets
        LIBRARY DESTINATION ${LIBRARIES} COMPONENT client NAMELINK_COMPONENT dev)
foreach(HEADER client.h clocks.h navigation.h)
  list(APPEND CLIENT_HEADERS ${PROJECT_SOURCE_DIR}/procs/client/${HEADER})
endforeach()
install(FILES ${CLIENT_HEADERS} DESTINATION include/vismap COMPONENT dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/procs/examples DESTINATION ${DOC}/vismap-dev COMPONENT dev)
install(EXPORT vismapTargets NAMESPACE vismap:: DESTINATION ${LIBRARIES}/cmake/vismap COMPONENT dev)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vismapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/vismapConfig.cmake.in ${PROJECT_BINARY_DIR}/vismapConfig.cmake
                              INSTALL_DESTINATION ${LIBRARIES}/cmake/vismap)
install(FILES ${PROJECT_BINARY_DIR}/vismapConfig.cmake ${PROJECT_BINARY_DIR}/vismapConfigVersion.cmake
        ${CMAKE_CURRENT_LIST_DIR}/FindLcmAny.cmake DESTINATION ${LIBRARIES}/cmake/vismap COMPONENT dev)
foreach(MODULE vismap vismap-client)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${MODULE}.pc.in ${PROJECT_BINARY_DIR}/${MODULE}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${MODULE}.pc DESTINATION ${LIBRARIES}/pkgconfig COMPONENT dev)
endforeach()

# What lintian warns of and is meant so, with the reasons.
foreach(PACKAGE_COMPONENT vismap:deploy libvismap-client0:client)
  string(REPLACE ":" ";" PAIR ${PACKAGE_COMPONENT})
  list(GET PAIR 0 PACKAGE)
  list(GET PAIR 1 COMPONENT)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/deb/${PACKAGE}.lintian-overrides
          DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${PACKAGE} COMPONENT ${COMPONENT})
endforeach()

# Habits of a Debian system: completion in bash, and manual pages, which help2man makes of --help.
set(COMPLETION ${PROJECT_BINARY_DIR}/completion)
set(MANUAL ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${COMPLETION} ${MANUAL})
get_property(PROGRAMS GLOBAL PROPERTY VISMAP_PROGRAMS)
configure_file(${CMAKE_CURRENT_LIST_DIR}/deb/completion.bash ${COMPLETION}/vismap COPYONLY)
install(FILES ${COMPLETION}/vismap DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT deploy)
foreach(PROGRAM ${PROGRAMS} vismap-launch vismap-deploy-check)
  file(CREATE_LINK vismap ${COMPLETION}/${PROGRAM} SYMBOLIC)
  install(FILES ${COMPLETION}/${PROGRAM} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT deploy)
endforeach()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_custom_target(manual COMMAND Python3::Interpreter -B ${PROJECT_SOURCE_DIR}/scripts/man_pages.py
                  ${PROJECT_BINARY_DIR}/bin ${PROJECT_SOURCE_DIR}/scripts ${MANUAL} ${PROJECT_VERSION}
                  DEPENDS ${PROGRAMS} COMMENT "Manual pages" VERBATIM)
install(DIRECTORY ${MANUAL}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT deploy)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME vismap)
set(CPACK_PACKAGE_CONTACT "the vismap authors <vismap@packages.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};vismap;ALL;/")
set(CPACK_COMPONENTS_ALL runtime deploy client dev python)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ROBOT_PACKAGE_NAME vismap)
set(CPACK_DEBIAN_ROBOT_DESCRIPTION "The processes of vismap (hub, detector, depth segmenter, map server,
octomap exporter), their systemd units, and tools that start and check them on
a robot computer.")
set(CPACK_DEBIAN_ROBOT_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ROBOT_PACKAGE_RECOMMENDS "python3, nftables, systemd, liblcm-bin")
set(CPACK_DEBIAN_ROBOT_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/postinst ${CMAKE_CURRENT_LIST_DIR}/deb/prerm
    ${PROJECT_BINARY_DIR}/deb/conffiles)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libvismap-client${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "The library with which other programs publish and subscribe on the bus of
vismap.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
file(WRITE ${PROJECT_BINARY_DIR}/deb/client/triggers "activate-noawait ldconfig\n")
file(WRITE ${PROJECT_BINARY_DIR}/deb/client/shlibs
     "libvismap-client ${PROJECT_VERSION_MAJOR} libvismap-client${PROJECT_VERSION_MAJOR} (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/deb/client/triggers
    ${PROJECT_BINARY_DIR}/deb/client/shlibs)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME vismap-dev)
set(CPACK_DEBIAN_DEV_DESCRIPTION "The .lcm files, C++ headers made of them that are safe against messages of
anybody, a client library, and their CMake and pkg-config files.")
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libvismap-client${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), liblcm-dev, liblcm-bin")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-vismap)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "The Python package vismap: publish frames of a camera from arrays, read
the live map, its objects and free space as numpy arrays, save and load maps,
and read and write logs of LCM messages.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy, libzstd1, libxxhash0")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pil")  # for colour that is a JPEG
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/python/postinst
    ${CMAKE_CURRENT_LIST_DIR}/deb/python/prerm)
file(GLOB CONFFILES RELATIVE ${DEPLOY}/etc CONFIGURE_DEPENDS ${DEPLOY}/etc/*)
list(TRANSFORM CONFFILES PREPEND /etc/vismap/)
list(JOIN CONFFILES "\n" CONFFILES)
file(WRITE ${PROJECT_BINARY_DIR}/deb/conffiles "${CONFFILES}\n")

include(CPack)
cpack_add_component_group(robot)
cpack_add_component_group(library)
cpack_add_component_group(dev)
cpack_add_component_group(python)
cpack_add_component(runtime GROUP robot)
cpack_add_component(deploy GROUP robot)
cpack_add_component(client GROUP library)
cpack_add_component(dev GROUP dev)
cpack_add_component(python GROUP python)
