// The files of the page. The build embeds them from sim/front_ends/panel/page into the program.
#pragma once

#include <string_view>

namespace ex9000::sim {

struct PageFile {
  std::string_view target;  ///< path of the request, for example `/panel.js`
  std::string_view type;    ///< for example `text/javascript; charset=utf-8`
  std::string_view content;
};

/// Returns the file for the path of a request; null if there is no such file.
const PageFile* page_file(std::string_view target);

}  // namespace ex9000::sim
