# Of what is added by a file of its own: each FOLDER/NAME_KIND.cpp defines the entry NAME_KIND, and
# generated/LIST.h lists the names as MRHI_ENTRIES(ENTRY), for the file that has the registry, KEEPER.
function(write_registry folder kind keeper list)
  file(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/${folder} ${folder}/*_${kind}.cpp)
  list(REMOVE_ITEM files ${keeper})
  set(entries "")
  foreach(file ${files})
    string(REPLACE ".cpp" "" entry ${file})
    string(APPEND entries "ENTRY(${entry}) ")
  endforeach()
  configure_file(cmake/registry.h.in generated/${list}.h @ONLY)
endfunction()
