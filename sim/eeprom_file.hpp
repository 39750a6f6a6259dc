// A module's EEPROM as a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/bytes.hpp"

namespace ex9000::sim {

/// What an image holds, for who but reads it: it may be read-only, and a running simulator may have it; what
/// that is just writing is there in part then, as after a power cut. Nothing where there is no file. Throws
/// std::invalid_argument, one line, where that is no image or cannot be read.
std::optional<std::vector<std::uint8_t>> read_eeprom_file(const std::string& path);

/// An image of the whole memory, byte for byte as the chip holds it: 8192 bytes, erased ones FF. Locked
/// against other processes while this object lives.
///
/// What `write` has returned true for is in the hands of the kernel: it survives the end of this process, of
/// whatever kind, though not that of the machine.
class EepromFile {
 public:
  /// Opens and locks what is there. Throws std::invalid_argument, one line, where that is no image, cannot be
  /// written or is in use. Creates nothing.
  explicit EepromFile(std::string path);
  ~EepromFile();
  EepromFile(const EepromFile&) = delete;
  EepromFile& operator=(const EepromFile&) = delete;

  /// What the file held when it was opened; nothing where there was none.
  [[nodiscard]] const std::optional<std::vector<std::uint8_t>>& found() const { return found_; }
  /// Makes the file, with all of `image` or not at all. Throws as the constructor does.
  void create(const std::vector<std::uint8_t>& image);
  /// False where the system refuses.
  [[nodiscard]] bool write(std::uint16_t address, Bytes bytes) const;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  [[noreturn]] void refuse(const std::string& why);
  void lock();

  std::string path_;
  int fd_ = -1;
  std::optional<std::vector<std::uint8_t>> found_;
};

}  // namespace ex9000::sim
