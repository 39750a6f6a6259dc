// A module's EEPROM as a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/bytes.hpp"
#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// Reads the content of an image, without write access and without a lock: the image may be read-only, and a
/// running simulator may use it. If the simulator writes to the image during this call, the result may
/// contain only a part of this write. Returns nullopt if there is no file. Throws std::invalid_argument with
/// a one-line message if the file is not an image or is not readable.
std::optional<std::vector<std::uint8_t>> read_eeprom_file(const std::string& path);

/// An image of the whole EEPROM, byte for byte: 8192 bytes; erased bytes are FFh. While this object has the
/// file open, the file is locked: no other EepromFile can open it, in this process or in another one.
///
/// When `write` returns true, the kernel has the data. The data survives any end of this process, but may be
/// lost if the machine crashes.
class EepromFile {
 public:
  /// Opens and locks an existing file. Throws std::invalid_argument with a one-line message if the file is
  /// not an image or cannot be read and written, and std::runtime_error if it is in use. Does not create a
  /// file.
  explicit EepromFile(std::string path);

  /// Returns the content that the file had when the constructor opened it; nullopt if there was no file.
  [[nodiscard]] const std::optional<std::vector<std::uint8_t>>& found() const { return found_; }
  /// Creates the file with the whole image or not at all, and locks it. Throws std::invalid_argument with a
  /// one-line message if the file exists or cannot be created.
  void create(const std::vector<std::uint8_t>& image);
  /// Writes `bytes` at `address`. Call this only if the file was found or created. Returns false if the
  /// system call fails; errno then has the reason.
  [[nodiscard]] bool write(std::uint16_t address, Bytes bytes) const;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  FileDescriptor file_;
  std::optional<std::vector<std::uint8_t>> found_;
};

}  // namespace ex9000::sim
