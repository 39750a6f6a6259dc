#include <algorithm>

#include "sim/text/values.hpp"
#include "sim/utility/device/device.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

constexpr unsigned kModelText = registers_of("model-text");
constexpr unsigned kModelTextSize = size_of("model-text");
constexpr unsigned kVersionText = registers_of("version-text");
constexpr unsigned kVersionTextSize = size_of("version-text");
constexpr unsigned kSerialNumber = registers_of("serial-number");

/// Without what the module does not have.
template <class Read>
auto if_there(Read read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const Absent&) {
    return std::nullopt;
  }
}

/// `text`: as register 0x00C8 has it, without `EX` and `-`.
const Model* model_with_short_text(const std::string& text) {
  const auto* const found = std::find_if(std::begin(kModels), std::end(kModels), [&](const Model& model) {
    std::string designation(model.designation.substr(2));
    designation.erase(std::remove(designation.begin(), designation.end(), '-'), designation.end());
    return designation == text;
  });
  return found == std::end(kModels) ? nullptr : found;
}

/// The first one with this code: others differ in what no master can see.
const Model* model_with_code(unsigned code) {
  const auto has_code = [code](const Model& model) { return model.modbus_code == code; };
  const auto* const found = std::find_if(std::begin(kModels), std::end(kModels), has_code);
  return found == std::end(kModels) ? nullptr : found;
}

const Model* model_with_factory_name(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kModels), std::end(kModels),
                                         [&](const Model& model) { return model.factory_name == name; });
  return found == std::end(kModels) ? nullptr : found;
}

std::optional<std::uint32_t> serial_number_of(Device& device) {
  const auto number = if_there([&] { return device.long_extension(kSerialNumber); });
  return number && *number != 0 ? number : std::nullopt;
}

Identity identify_in_modbus(Device& device) {
  constexpr unsigned kCodeAt = registers_of("module-code");
  Identity identity;
  if (const auto text =
          if_there([&] { return device.read(read_words(kModelText, kModelTextSize)).text(); })) {
    identity.model = model_with_short_text(*text);
    identity.model_text = *text;
  } else if (const auto code = if_there([&] { return device.read(read_words(kCodeAt, 2)); })) {
    // 0x0090, 0x4200 for the code 0x9042
    const unsigned number = code->word(0) << 8U | code->word(1) >> 8U;
    identity.model = model_with_code(number);
    identity.model_text = "code " + sim::hex_word_text(number);
  }
  if (const auto text =
          if_there([&] { return device.read(read_words(kVersionText, kVersionTextSize)).text(); })) {
    identity.version = *text;
  }
  identity.name = if_there([&] { return name_in_modbus(device); }).value_or("");
  identity.serial_number = serial_number_of(device);
  return identity;
}

Identity identify_in_ascii(Device& device) {
  Identity identity;
  identity.name = device.ask("$AAM");
  identity.model = model_with_factory_name(identity.name);
  identity.version = if_there([&] { return device.ask("$AAF"); }).value_or("");
  identity.serial_number = serial_number_of(device);
  return identity;
}

}  // namespace

/// Function 11: two bytes of the code, FF, then the name.
std::string name_in_modbus(Device& device) {
  constexpr std::size_t kNameAt = 4;  // after the count
  const Data data = device.read(report_server_id()).data;
  if (data.size() <= kNameAt) {
    throw Absent("tells no name");
  }
  std::string name(data.begin() + kNameAt, data.end());
  if (!Name(std::string_view(name)).is_possible(kMaxNameLength)) {
    throw Absent("tells a name that is not printable");
  }
  return name;
}

Identity identify(Device& device) {
  Identity identity = device.speaks_modbus() ? identify_in_modbus(device) : identify_in_ascii(device);
  if (identity.model != nullptr) {
    identity.model_text = identity.model->designation;
  }
  return identity;
}

}  // namespace ex9000::utility
