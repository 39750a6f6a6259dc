# Generates a source file from the page's files: cmake -DOUT=page_files.cpp "-DFILES=a.html;b.js" -P embed.cmake
set(types_html "text/html")
set(types_css "text/css")
set(types_js "text/javascript")
set(arrays "")
set(rows "")
set(index 0)
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  string(REGEX MATCH "[a-z]+$" ending ${name})
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "constexpr char kFile${index}[] = {${bytes}};\n")
  if(name STREQUAL "index.html")
    set(name "")
  endif()
  string(APPEND rows "    {\"/${name}\", \"${types_${ending}}; charset=utf-8\", {kFile${index}, sizeof kFile${index}}},\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUT} "// Generated from sim/front_ends/panel/page by embed.cmake.
#include \"sim/front_ends/panel/page_files.hpp\"

namespace ex9000::sim {

namespace {

${arrays}
constexpr PageFile kPageFiles[] = {
${rows}};

}  // namespace

const PageFile* page_file(std::string_view target) {
  for (const PageFile& file : kPageFiles) {
    if (file.target == target) {
      return &file;
    }
  }
  return nullptr;
}

}  // namespace ex9000::sim
")
