# vismap_proto(TARGET FILE.proto): the generated C++ of one .proto file of the current folder as a static library.
# Generated code is not held to our warnings; its header is included as "FILE.pb.h".
function(vismap_proto TARGET PROTO)
  get_filename_component(NAME ${PROTO} NAME_WE)
  set(OUT ${CMAKE_CURRENT_BINARY_DIR}/proto)
  add_custom_command(
    OUTPUT ${OUT}/${NAME}.pb.cc ${OUT}/${NAME}.pb.h
    COMMAND ${CMAKE_COMMAND} -E make_directory ${OUT}
    COMMAND protobuf::protoc --cpp_out=${OUT} --proto_path=${CMAKE_CURRENT_SOURCE_DIR}
            ${CMAKE_CURRENT_SOURCE_DIR}/${PROTO}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${PROTO}
    COMMENT "protoc: ${PROTO}"
    VERBATIM)
  add_library(${TARGET} STATIC ${OUT}/${NAME}.pb.cc ${OUT}/${NAME}.pb.h)
  target_include_directories(${TARGET} SYSTEM PUBLIC ${OUT})
  target_link_libraries(${TARGET} PUBLIC protobuf::libprotobuf)
endfunction()
