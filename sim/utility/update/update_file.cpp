#include "sim/utility/update/update_file.hpp"

#include <fstream>
#include <iterator>

#include "firmware/update/request.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"
#include "sim/text/values.hpp"

namespace ex9000::utility {

namespace {

[[noreturn]] void refuse(const std::string& problem) { sim::fail(problem + "; build or copy it again"); }

Bytes view(const Data& data) { return {data.data(), data.size()}; }

Data read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Data content{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    sim::unavailable(sim::reason() + "; name a file that you can read");
  }
  return content;
}

update::Info parse_info(Bytes bytes) {
  update::Info info;
  std::copy(bytes.begin(), bytes.end(), info.bytes.begin());
  const std::string signature(info.signature().begin(), info.signature().end());
  const std::size_t end = signature.find('\0');
  if (signature.find('.') >= end || signature.find_first_not_of('\0', end) != std::string::npos) {
    refuse("has no signature like 9042DM.pico");
  }
  if (info.length() == 0 || info.length() > update::kLargestImage) {
    refuse("gives the image " + std::to_string(info.length()) + " bytes, not 1 to " +
           std::to_string(update::kLargestImage));
  }
  return info;
}

UpdateFile parse(const Data& file) {
  constexpr std::size_t kBlock = update::kBlockMessageSize;
  if (file.size() <= update::kInfoSize || (file.size() - update::kInfoSize) % kBlock != 0) {
    refuse("has " + std::to_string(file.size()) + " bytes, not " + std::to_string(update::kInfoSize) +
           " and " + std::to_string(kBlock) + " for each block");
  }
  UpdateFile parsed{parse_info(view(file).first(update::kInfoSize)), {}};
  const std::uint32_t length = parsed.info.length();
  Crc32 crc;
  std::uint32_t offset = 0;
  for (Bytes rest = view(file).from(update::kInfoSize); rest.size != 0; rest = rest.from(kBlock)) {
    const Bytes block = rest.first(kBlock);
    if (block.double_word(0) != offset ||
        block.double_word(update::kBlockCheckAt) != update::crc32(block.first(update::kBlockCheckAt))) {
      refuse("has a damaged block at " + std::to_string(offset));
    }
    for (std::size_t i = 0; i < update::kBlockSize && offset < length; ++i, ++offset) {
      crc.add(block[update::kBlockDataAt + i]);
    }
    parsed.blocks.emplace_back(block.begin(), block.end());
  }
  if (offset != length || parsed.blocks.size() != (length + update::kBlockSize - 1) / update::kBlockSize ||
      crc.value() != parsed.info.check()) {
    refuse("has another length or CRC of the image than it says");
  }
  return parsed;
}

}  // namespace

std::string UpdateFile::signature() const {
  const std::string text(info.signature().begin(), info.signature().end());
  return text.substr(0, text.find('\0'));
}

std::string UpdateFile::version() const { return version_text(info.version()); }

std::string version_text(unsigned bcd) {
  return "D" + sim::hex_byte_text(bcd >> 8U) + "." + sim::hex_byte_text(bcd);
}

UpdateFile read_update_file(const std::string& path) {
  return sim::with_place(path + ": ", [&] { return parse(read(path)); });
}

}  // namespace ex9000::utility
