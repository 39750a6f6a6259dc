#include "tests/support/coverage.hpp"

#include <array>
#include <utility>

#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/dcon.hpp"
#include "firmware/line/dcon_assembler.hpp"
#include "firmware/line/rtu_assembler.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"

namespace ex9000::runner {

namespace {

constexpr std::array<std::pair<Refusal, const char*>, 13> kRefusals{{
    {Refusal::UnknownCommand, "UnknownCommand"},
    {Refusal::OutOfRange, "OutOfRange"},
    {Refusal::NotPermitted, "NotPermitted"},
    {Refusal::NoSample, "NoSample"},
    {Refusal::UnknownFunction, "UnknownFunction"},
    {Refusal::UnknownSubfunction, "UnknownSubfunction"},
    {Refusal::WrongLength, "WrongLength"},
    {Refusal::WrongQuantity, "WrongQuantity"},
    {Refusal::WrongCoilValue, "WrongCoilValue"},
    {Refusal::WrongAddress, "WrongAddress"},
    {Refusal::WrongValue, "WrongValue"},
    {Refusal::UnknownObject, "UnknownObject"},
    {Refusal::OutputsBlocked, "OutputsBlocked"},
    // A master cannot cause Refusal::StoreFailed, which requires a broken memory. See
    // tests/firmware/module_storing_test.cpp.
}};

constexpr std::array<std::pair<Verdict, const char*>, 6> kVerdicts{{
    {Verdict::Accepted, "Accepted"},
    {Verdict::HostOk, "HostOk"},
    {Verdict::Foreign, "Foreign"},
    {Verdict::BadCheck, "BadCheck"},
    {Verdict::TooShort, "TooShort"},
    {Verdict::TooLong, "TooLong"},
    // Open, Ignored and NoRoom are not required. LineError and Overrun are not required either: `note` passes
    // each byte to the assembler with ByteStatus::Good, so the assembler returns neither LineError nor
    // Overrun. See tests/firmware/line/*_assembler_test.cpp for tests of these two verdicts.
}};

std::string hex_code(unsigned code) {
  constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};
  return {kDigits[code / 16 % 16], kDigits[code % 16]};
}

template <class Table, class Key>
std::string name_in(const Table& table, Key key) {
  for (const auto& [value, name] : table) {
    if (value == key) {
      return name;
    }
  }
  return "";
}

template <class Register>
std::string register_id(const char* kind, const Register& row, unsigned function) {
  return std::string(kind) + "/" + std::string(row.id) + "/" + hex_code(function);
}

/// Returns the codes of `functions`. Function 0x10 is allowed for the same rows as 0x06.
/// `pairs`: 06 cannot write a value of 32 bits.
std::vector<unsigned> functions_of(registers::Functions functions, bool pairs = false) {
  std::vector<unsigned> codes;
  for (unsigned code = 1; code < 16; ++code) {
    if ((functions >> code & 1U) != 0) {
      if (code != 6 || !pairs) {
        codes.push_back(code);
      }
      if (code == 6) {
        codes.push_back(0x10);
      }
    }
  }
  return codes;
}

}  // namespace

void Coverage::note(const Module& module, const play::Bytes& sent, const play::Bytes& heard) {
  // Passes the bytes to a new assembler. The verdict of the new assembler can differ from the verdict of the
  // module's assembler. For example, if the transcript waits in the middle of a frame, `sent` is only a part
  // of the frame.
  const InForce& in_force = module.state().in_force;
  FrameQueue queue;
  Verdict verdict = Verdict::Open;
  if (in_force.protocol == Protocol::Ascii) {
    DconAssembler assembler;
    assembler.use_checksum(in_force.checksum);
    assembler.answer_to(in_force.address);
    for (const std::uint8_t byte : sent) {
      if (byte != DconAssembler::kEnd) {
        assembler.byte(queue, byte, ByteStatus::Good);
        continue;
      }
      const Verdict latest = assembler.end(queue, ByteStatus::Good, Time());
      verdict = latest == Verdict::Open ? verdict : latest;
    }
  } else {
    RtuAssembler assembler;
    assembler.use(LineTiming::at(module.baud(), module.format()));
    assembler.answer_to(in_force.address);
    for (const std::uint8_t byte : sent) {
      assembler.byte(queue, byte, ByteStatus::Good);
    }
    verdict = assembler.silence(queue, Time());
    if (verdict == Verdict::Open) {
      verdict = assembler.silence(queue, Time());
    }
  }
  if (verdict == Verdict::Foreign && !heard.empty()) {
    return;  // the request has changed the address, and the new assembler already uses the new address
  }
  const std::string name = name_in(kVerdicts, verdict);
  if (!name.empty()) {
    reached_.insert("verdict/" + name);
  }
  if (verdict == Verdict::HostOk) {
    reached_.insert(in_force.protocol == Protocol::Ascii ? "dcon/host-ok" : "register/host-ok");
  }
  if (!queue.has_frame()) {
    return;
  }
  const ex9000::Bytes frame = queue.waiting().bytes();
  const bool ascii = in_force.protocol == Protocol::Ascii;
  if (ascii && frame[1] == '*') {
    reached_.insert("dcon/sample");
  } else if (!heard.empty()) {
    note_answered(module, frame);
  }
}

void Coverage::note_answered(const Module& module, ex9000::Bytes frame) {
  const Refusal refusal = module.outcome().refusal;  // belongs to this frame, because the module has replied
  if (refusal != Refusal::None) {
    reached_.insert("refusal/" + name_in(kRefusals, refusal));
    return;
  }
  const Model& model = module.state().model();
  if (module.state().in_force.protocol == Protocol::Ascii) {
    const std::size_t command = dcon::find_command(model, frame);
    if (command != dcon::kNoCommand) {
      reached_.insert("dcon/" + std::string(dcon::kCommands[command].id));
    }
    return;
  }
  const unsigned function = frame[1];
  reached_.insert("modbus/" + hex_code(function));
  if (frame.size < 6 || function > 0x10) {
    return;
  }
  const unsigned listed = function == 0x10 ? 6 : function;
  const auto bit = static_cast<registers::Functions>(1U << listed);
  for (const auto& row : registers::kBitRegisters) {
    const unsigned index = unsigned{frame.word(2)} - row.row.first;
    if ((row.row.functions & bit) != 0 && index < registers::width_of(row.row.width, model)) {
      reached_.insert(register_id("coil", row, function));
    }
  }
  for (const auto& row : registers::kWordRegisters) {
    const unsigned index = unsigned{frame.word(2)} - row.row.first;
    if ((row.row.functions & bit) != 0 && index < registers::width_of(row.row.width, model)) {
      reached_.insert(register_id("register", row, function));
    }
  }
}

std::set<std::string> Coverage::missing() const {
  std::set<std::string> wanted{"register/host-ok"};
  for (const auto& command : dcon::kCommands) {
    wanted.insert("dcon/" + std::string(command.id));
  }
  for (const auto& function : modbus::kFunctions) {
    wanted.insert("modbus/" + hex_code(function.row.code));
  }
  for (const auto& row : registers::kBitRegisters) {
    for (const unsigned function : functions_of(row.row.functions)) {
      wanted.insert(register_id("coil", row, function));
    }
  }
  for (const auto& row : registers::kWordRegisters) {
    for (const unsigned function : functions_of(row.row.functions, row.row.has(registers::kLong))) {
      wanted.insert(register_id("register", row, function));
    }
  }
  for (const auto& [refusal, name] : kRefusals) {
    wanted.insert(std::string("refusal/") + name);
  }
  for (const auto& [verdict, name] : kVerdicts) {
    wanted.insert(std::string("verdict/") + name);
  }
  for (const std::string& id : reached_) {
    wanted.erase(id);
  }
  return wanted;
}

}  // namespace ex9000::runner
