#include "sim/app/play/steps.hpp"

#include <algorithm>
#include <utility>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/app/play/playing.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/notation/shape.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::play {

namespace {

using sim::fail;
using sim::parse_on_off;
using sim::Words;
using Run = std::function<void(Playing& playing)>;

/// A step with a keyword.
struct Row {
  std::string_view shape;
  enum class Of {
    Any,         ///< transcripts and scenarios
    AnyActs,     ///< the same, and the step changes a module
    AnyOnInput,  ///< the same, and the first argument is an input of the module
    Scenarios,
  } of;
  Run (*parse)(const Words& args);
};

Run supply(const Words& args) {
  return [on = parse_on_off(args[0])](Playing& playing) {
    playing.nothing_more();
    playing.target().power(on);
  };
}

Run power_cycle(const Words& /*args*/) {
  return [](Playing& playing) {
    playing.nothing_more();
    playing.target().power(false);
    playing.target().power(true);
  };
}

Run reset(const Words& /*args*/) {
  return [](Playing& playing) {
    playing.nothing_more();
    playing.target().reset();
  };
}

Run baud(const Words& args) {
  return [rate = sim::parse_baud_rate(args[0])](Playing& playing) {
    playing.nothing_more();
    playing.target().set_baud(rate);
  };
}

Run led(const Words& args) {
  for (const Led shows : {Led::On, Led::Off, Led::Flashing}) {
    if (args[0] == led_text(shows)) {
      return [shows](Playing& playing) { playing.expect_led(shows); };
    }
  }
  fail("'" + args[0] + "': expected on, off or flashing");
}

Run module(const Words& args) {
  constexpr unsigned long kMostModules = 999'999;
  return [position = sim::parse_whole_number(args[0], 1, kMostModules) - 1](Playing& playing) {
    playing.nothing_more();
    playing.target().choose_module(position);
  };
}

Run line(const Words& args) {
  return [name = args[0]](Playing& playing) {
    playing.nothing_more();
    playing.target().choose_line(name);
  };
}

constexpr Row kRows[] = {
    {"bytes HEX...", Row::Of::Any,
     [](const Words& args) -> Run {
       return
           [bytes = sim::parse_hex_bytes(sim::joined(args))](Playing& playing) { playing.send_more(bytes); };
     }},
    {"silence", Row::Of::Any,
     [](const Words& /*args*/) -> Run { return [](Playing& playing) { playing.nothing_for(kSilence); }; }},
    {"wait TIME", Row::Of::Any,
     [](const Words& args) -> Run {
       return [time = sim::parse_time(args[0])](Playing& playing) { playing.nothing_for(time); };
     }},
    {"checksum on|off", Row::Of::Any,
     [](const Words& args) -> Run {
       return [on = parse_on_off(args[0])](Playing& playing) { playing.set_checksum(on); };
     }},
    {"baud RATE", Row::Of::Any, baud},
    {"format 8N1|8N2|8E1|8O1", Row::Of::Any,
     [](const Words& args) -> Run {
       return [format = sim::parse_line_format(args[0])](Playing& playing) {
         playing.target().set_format(format);
       };
     }},
    {"power on|off", Row::Of::AnyActs, supply},
    {"power-cycle", Row::Of::AnyActs, power_cycle},
    {"reset", Row::Of::AnyActs, reset},
    {"init on|off", Row::Of::AnyActs,
     [](const Words& args) -> Run {
       return [on = parse_on_off(args[0])](Playing& playing) { playing.target().set_init(on); };
     }},
    {"input C on|off", Row::Of::AnyOnInput,
     [](const Words& args) -> Run {
       return [channel = sim::parse_pulses({args[0]}).channel, on = parse_on_off(args[1])](Playing& playing) {
         playing.target().set_input(channel, on);
       };
     }},
    {"pulse C [xCOUNT]", Row::Of::AnyOnInput,
     [](const Words& args) -> Run {
       return [pulses = sim::parse_pulses(args)](Playing& playing) {
         playing.target().pulse_input(pulses.channel, pulses.count);
       };
     }},
    {"outputs HHHH", Row::Of::Any,
     [](const Words& args) -> Run {
       return
           [channels = sim::parse_hex_word(args[0])](Playing& playing) { playing.expect_outputs(channels); };
     }},
    {"led on|off|flashing", Row::Of::Any, led},
    {"module N", Row::Of::Scenarios, module},
    {"line NAME", Row::Of::Scenarios, line},
};

/// Of the control socket, on module N or on the chosen line.
Run action(const Words& words) {
  return [words](Playing& playing) { playing.target().act(words); };
}

bool is_action(const std::string& word) {
  return word.find_first_not_of("0123456789") == std::string::npos || word == "fault";
}

[[noreturn]] void refuse(const std::string& text) {
  std::string shapes = "> TEXT, < TEXT, => HEX, <= HEX";
  for (const Row& row : kRows) {
    shapes += ", " + std::string(row.shape);
  }
  fail("'" + text + "' is not a step; expected one of " + shapes +
       ", N ACTION, fault FAULT, fault off K|all");
}

/// `HEX` or `HEX or HEX ...`. The bytes FF before a frame are those of an arbitration (extensions.md, scan).
Run parse_modbus_reply(const std::string& text) {
  const std::string separator = " or ";
  std::vector<Bytes> permitted;
  for (std::size_t from = 0, end = 0; end != std::string::npos; from = end + separator.size()) {
    end = text.find(separator, from);
    const Bytes bytes = sim::parse_hex_bytes(text.substr(from, end == std::string::npos ? end : end - from));
    const auto frame =
        std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte != 0xFF; });
    Bytes reply(bytes.begin(), frame);
    if (frame != bytes.end()) {
      const Bytes checked = with_crc({frame, bytes.end()});
      reply.insert(reply.end(), checked.begin(), checked.end());
    }
    permitted.push_back(std::move(reply));
    if (permitted.back().size() != permitted.front().size()) {
      fail("'" + text + "': the replies differ in length; expected replies of the same length");
    }
  }
  return [permitted = std::move(permitted)](Playing& playing) { playing.expect_one_of(permitted); };
}

/// A step that sends a frame or expects one; null: any other step.
Run parse_frame(const std::string& text) {
  for (const std::string lead : {"<=", "=>", "<", ">"}) {
    if (text.rfind(lead, 0) != 0) {
      continue;
    }
    std::string rest = text.substr(lead.size());
    if (!rest.empty() && rest[0] != ' ' && rest[0] != '\t') {
      fail(std::string("'").append(text).append("': expected a blank after ").append(lead));
    }
    rest.erase(0, 1);
    if (lead == "<=") {
      return parse_modbus_reply(rest);
    }
    if (lead == "=>") {
      return [frame = with_crc(sim::parse_hex_bytes(rest))](Playing& playing) { playing.send(frame); };
    }
    if (lead == "<") {
      return [rest](Playing& playing) { playing.expect_dcon(rest); };
    }
    return [rest](Playing& playing) { playing.send_dcon(rest); };
  }
  return nullptr;
}

[[noreturn]] void refuse_in_transcripts(const std::string& text) {
  fail("'" + text + "': only scenarios have this step; remove the step or the 'model:' lines");
}

}  // namespace

Step parse_step(unsigned line, const std::string& text, const Model* model) {
  if (Run run = parse_frame(text)) {
    return {line, text, std::move(run), false};
  }
  const Words words = sim::words_of(text);
  const Words args(words.begin() + 1, words.end());
  for (const Row& row : kRows) {
    if (!sim::is_shape_of(row.shape, words[0])) {
      continue;
    }
    sim::check_shape(row.shape, args, "'" + text + "': expected ");
    Run run = row.parse(args);
    if (model != nullptr && row.of == Row::Of::Scenarios) {
      refuse_in_transcripts(text);
    }
    if (model != nullptr && row.of == Row::Of::AnyOnInput) {
      sim::parse_input(args[0], *model);
    }
    return {line, text, std::move(run), row.of != Row::Of::Any};
  }
  if (!is_action(words[0])) {
    refuse(text);
  }
  if (model != nullptr) {
    refuse_in_transcripts(text);
  }
  if (words.size() > 1 && sim::only_reads(words[1])) {
    fail("'" + text +
         "': only reads, and a scenario prints nothing; expected a step that checks, for example 'outputs "
         "0001'");
  }
  return {line, text, action(words), true};
}

}  // namespace ex9000::play
