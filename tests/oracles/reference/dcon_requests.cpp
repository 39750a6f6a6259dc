#include <string>

#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/generator.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::reference {

namespace {

std::string digit(Random& random) { return hex(random.below(16), 1); }

std::string digits(Random& random, unsigned count) {
  std::string text;
  for (unsigned i = 0; i < count; ++i) {
    text += digit(random);
  }
  return text;
}

std::string byte_text(Random& random, unsigned lowest, unsigned highest) {
  return hex(random.between(lowest, highest), 2);
}

std::string noise(Random& random, unsigned longest) {
  std::string text;
  for (unsigned i = random.between(1, longest); i != 0; --i) {
    text += static_cast<char>(random.once_in(4) ? random.below(256) : random.between(0x20, 0x7E));
  }
  return text;
}

/// Returns a CC whose rate is in range or just out of range.
std::string baud_code(const Module& module, Random& random) {
  return hex(baud_code_with(random.between(0x02, 0x0B), module, random), 2);
}

std::string configuration(const Module& module, Random& random) {
  const Stored& stored = module.stored();
  std::string text = random.once_in(3) ? random.one_of<std::string>({"00", "01", "F7", "F8", "FF", "2A"})
                                       : hex(stored.address, 2);
  text += random.once_in(6) ? random.one_of<std::string>({"24", "24", "41", "00", "FF"}) : "40";
  text += random.once_in(module.init_mode() ? 2 : 6) ? baud_code(module, random) : hex(stored.baud_code, 2);
  text += random.once_in(3) ? random.one_of<std::string>({"00", "40", "80", "C0", "C0", "01", "20", "60"})
                            : hex(stored.format ^ (random.once_in(3) ? 0x80U : 0U), 2);
  return text;
}

std::string outputs(const Module& module, Random& random) {
  const unsigned all = (1U << module.row().outputs) - 1;
  const unsigned longest = module.row().outputs <= 4 ? 1 : module.row().outputs <= 8 ? 2 : 4;
  unsigned value = random.below(0x10000) & all;
  unsigned count = longest;
  if (random.once_in(3)) {
    count = random.between(1, 5);
  }
  if (random.once_in(6)) {
    value = all + random.below(2);
  }
  return hex(value, count);
}

std::string group_or_single(Random& random) {
  switch (random.below(8)) {
    case 0:
    case 1:
    case 2:
      return random.one_of<std::string>({"00", "0A", "0B"}) +
             (random.once_in(3)
                  ? random.one_of<std::string>({"1F", "20", "FF", "00", "07", "08", "7F", "80", "0F", "10"})
                  : digits(random, 2));
    case 3:
    case 4:
    case 5:
      return random.one_of<std::string>({"1", "A", "B"}) + digit(random) +
             random.one_of<std::string>({"00", "01"});
    case 6:
      return random.one_of<std::string>({"1", "A", "B"}) + hex(random.below(8), 1) +
             byte_text(random, 0x00, 0x03);
    default:
      return digits(random, random.between(2, 5));
  }
}

std::string name(const Module& module, Random& random) {
  std::string text;
  for (unsigned i = random.between(0, 8); i != 0; --i) {
    text += static_cast<char>(random.once_in(40) ? random.one_of({0x00, 0x0A, 0x1F, 0x7F, 0x80, 0xFF})
                                                 : static_cast<int>(random.between(0x20, 0x7E)));
  }
  return random.once_in(8) ? module.row().name : text;
}

/// Returns the digits after `~AAX`.
std::string extension(const Module& module, Random& random) {
  const unsigned address = extension_address(module, random);
  if (random.once_in(12)) {
    return random.once_in(2) ? digits(random, random.between(0, 9))
                             : hex(address, 4) + digits(random, random.between(1, 3));
  }
  return hex(address, 4) + (random.once_in(3) ? hex(extension_content(module, address, random), 4) : "");
}

/// Returns the number of one of the cases in `command`. For a module without extensions, never returns a case
/// of an extension.
unsigned kind_of_command(const Module& module, Random& random) {
  constexpr unsigned kAll = 39;
  constexpr unsigned kFirstExtension = 29;
  constexpr unsigned kExtensions = 7;
  if (module.has_extensions()) {
    return random.below(kAll);
  }
  const unsigned kind = random.below(kAll - kExtensions);
  return kind < kFirstExtension ? kind : kind + kExtensions;
}

/// Returns delimiter, address and body of a command, or of something similar to a command.
std::string command(const Module& module, Random& random) {
  const std::string aa = hex(module.address(), 2);
  const std::string channel =
      random.once_in(8) ? digit(random) : hex(random.below(module.row().inputs > 8 ? 16 : 8), 1);
  switch (kind_of_command(module, random)) {
    case 0:
    case 1:
      return "%" + aa + configuration(module, random);
    case 2:
      return "#**";
    case 3:
      return "~**";
    case 4:
    case 5:
    case 6:
      return "#" + aa + group_or_single(random);
    case 7:
    case 8:
      return "#" + aa + channel;
    case 9:
    case 10:
      return "@" + aa;
    case 11:
    case 12:
    case 13:
      return "@" + aa + outputs(module, random);
    case 14:
      return "$" + aa + "C";
    case 15:
      return "$" + aa + "C" + channel;
    case 16:
    case 17:
      return "$" + aa + "L" + random.one_of<std::string>({"0", "1", "0", "1", "0", "1", "2", ""});
    case 18:
      return "$" + aa + "P" + random.one_of<std::string>({"", "", "0", "1", "0", "1", "2", "01"});
    case 19:
      return "$" + aa + "P" + random.one_of<std::string>({"0", "1"});
    case 20:
      return "~" + aa + "O" + name(module, random);
    case 21:
      return "~" + aa + "0";
    case 22:
      return "~" + aa + "1";
    case 23:
      return "~" + aa + "2";
    case 24:
    case 25:
      return "~" + aa + "3" + random.one_of<std::string>({"0", "1", "1", "1", "1", "1", "2", "A"}) +
             (random.once_in(3) ? digits(random, random.between(0, 3)) : byte_text(random, 0x00, 0x18));
    case 26:
    case 27:
      return "~" + aa + random.one_of<std::string>({"4", "5"}) +
             random.one_of<std::string>({"P", "S", "P", "S", "P", "S", "", "p", "T", "PS"});
    case 28:
      return random.one_of<std::string>({"#", "$", "%", "@", "~"}) + aa + noise(random, 8);
    case 29:
    case 30:
    case 31:
    case 32:
    case 33:
      return "~" + aa + "X" + extension(module, random);
    case 34:
      return "~" + aa + random.one_of<std::string>({"RD", "RD", "RD", "R", "RE", "RD0", "RD0A1"});
    case 35:
      return "~" + aa + "RD" + byte_text(random, 0x00, kLongestDelay + 1);
    default:
      return "$" + aa + random.one_of<std::string>({"2", "4", "4", "5", "6", "F", "M"});
  }
}

/// Returns the frame with one change. In most cases the module does not accept the changed frame.
std::string with_one_mistake(const Module& module, std::string frame, Random& random) {
  switch (random.below(8)) {
    case 0:  // another address, or by chance the same one
      return frame.substr(0, 1) +
             random.one_of<std::string>({"00", "01", "02", "10", "FF", "0a", "**", "*1"}) +
             frame.substr(std::min<std::size_t>(frame.size(), 3));
    case 1:
      return frame.substr(0, random.below(static_cast<unsigned>(frame.size()) + 1));
    case 2:
      return frame + noise(random, 3);
    case 3:  // around the greatest length that the module accepts
      frame.resize(random.between(28, 36), random.one_of({' ', 'x', '0'}));
      return frame;
    case 4:
      for (char& character : frame) {
        if (character >= 'A' && character <= 'Z') {
          character = static_cast<char>(character - 'A' + 'a');
        }
      }
      return frame;
    case 5:
      frame[random.below(static_cast<unsigned>(frame.size()))] = static_cast<char>(random.below(256));
      return frame;
    case 6:
      return random.one_of<std::string>({"#", "$", "%", "@", "~", "&", "!", "?"}) + frame.substr(1);
    default:
      return "~" + hex(module.address(), 2) + "O" + frame.substr(0, 4);
  }
}

/// Appends CHK if the module uses the checksum. Sometimes CHK is wrong, missing or unnecessary.
std::string checked(const Module& module, const std::string& frame, Random& random) {
  const std::string check = check_of(frame);
  if (random.once_in(12)) {
    switch (random.below(4)) {
      case 0:
        return frame + (module.checksum() ? "" : check);
      case 1:
        return frame + digits(random, 2);
      case 2: {
        std::string lower = check;
        for (char& character : lower) {
          character = static_cast<char>(character >= 'A' ? character - 'A' + 'a' : character);
        }
        return frame + lower;
      }
      default:
        return frame + check.substr(0, 1);
    }
  }
  return module.checksum() ? frame + check : frame;
}

}  // namespace

Bytes dcon_request(const Module& module, Random& random) {
  std::string frame = command(module, random);
  if (random.once_in(10)) {
    frame = with_one_mistake(module, frame, random);
  }
  std::string sent = checked(module, frame, random) + "\r";
  switch (random.below(60)) {
    case 0:  // without CR: the next frame continues this one
      sent.pop_back();
      break;
    case 1:
      sent = noise(random, 40);
      break;
    case 2:
      sent = random.one_of<std::string>({"\n", std::string(1, '\0'), "\r", " ", "\n\r"}) + sent;
      break;
    case 3:  // begins like another module's reply
      sent = random.one_of<std::string>({"!", ">", "?"}) + noise(random, 4) + sent +
             (random.once_in(2) ? sent : "");
      break;
    case 4:
      sent = "$" + hex(module.address() ^ 0x10U, 2) + "M\r" + sent;
      break;
    case 5:  // immediately after a command that gets no reply
      sent = checked(module, random.one_of<std::string>({"~**", "#**"}), random) + "\r" + sent;
      break;
    default:
      break;
  }
  return Bytes(sent.begin(), sent.end());
}

}  // namespace ex9000::reference
