// Settings of the simulator, in tables for the command line, bus files, their schema, --help and documents.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/text/fail.hpp"
#include "sim/text/places.hpp"

namespace ex9000::sim {

/// How people write a value. In a bus file, `true` and `false` mean on and off.
enum class Form : std::uint8_t {
  Flag,      ///< on or off; an option without a value: on
  Text,      ///< one value
  Choice,    ///< one of the words in Setting::value
  Optional,  ///< like Text, but an option without a value means on
  List,      ///< any number of values: an option several times, or a list
};

template <class Object>
struct Setting {
  std::string_view name;  ///< `--NAME`, and the key in a bus file
  Form form = Form::Text;
  std::string_view
      value;  ///< stands for the value in help: a word in capitals, or the choices, separated by |
  std::string_view does;  ///< for help and documents: a verb phrase, then the default
  void (*take)(Object& object, const std::string& value) = nullptr;
};

/// An error begins with `place`.
template <class Object>
void take_setting(const Setting<Object>& setting, Object& object, const std::string& place,
                  const std::string& value) {
  object.places[std::string(setting.name)] = place;
  with_place(place, [&] { setting.take(object, value); });
}

}  // namespace ex9000::sim
