// A module's EEPROM as a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/bytes.hpp"
#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// Reads without write access and without a lock: the image may be read-only or in use by a simulator, and a
/// write during this call may be there only in part. nullopt: no file.
std::optional<std::vector<std::uint8_t>> read_eeprom_file(const std::string& path);

/// An image of the whole EEPROM: 8192 bytes, erased ones FFh. While open, it is locked against every other
/// EepromFile, in this process or another. What `write` has written is in the kernel: it survives any end of
/// this process, but perhaps not a crash of the machine.
class EepromFile {
 public:
  /// Opens and locks an existing file; creates none. std::runtime_error: it is in use.
  explicit EepromFile(std::string path);

  /// The content when the constructor opened it; nullopt: no file.
  [[nodiscard]] const std::optional<std::vector<std::uint8_t>>& found() const { return found_; }
  /// Creates and locks the whole image, or nothing. The file must not exist.
  void create(const std::vector<std::uint8_t>& image);
  /// Only if the file was found or created. false: errno has the reason.
  [[nodiscard]] bool write(std::uint16_t address, Bytes bytes) const;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  FileDescriptor file_;
  std::optional<std::vector<std::uint8_t>> found_;
};

}  // namespace ex9000::sim
