#include "tests/oracles/reference/rules.hpp"

#include <iterator>
#include <stdexcept>

namespace ex9000::reference {

namespace {

/// Rules that a module applies with extensions and without.
const char* const kRules[] = {
    // wire.md 2
    "reset into ASCII",
    "reset into Modbus",
    "reset into INIT mode",
    "reset into 8N1",
    "reset to the power-on value",
    "reset to the safe value",
    // wire.md 3
    "ASCII frame too long",
    "ASCII frame too short",
    "ASCII frame spoiled",
    "ASCII frame for another address",
    "CHK right",
    "CHK wrong or missing",
    "unknown broadcast",
    // wire.md 4
    "%AANNTTCCFF",
    "%AANNTTCCFF with TT 24",
    "%AANNTTCCFF with a wrong form",
    "%AANNTTCCFF TT out of range",
    "%AANNTTCCFF CC out of range",
    "%AANNTTCCFF FF out of range",
    "%AANNTTCCFF NN out of range",
    "%AANNTTCCFF without permission",
    "%AANNTTCCFF 8N1",
    "#**",
    "#AABBDD group 00",
    "#AABBDD group 0A",
    "#AABBDD group 0B",
    "#AABBDD single 1c",
    "#AABBDD single Ac",
    "#AABBDD single Bc",
    "#AABBDD with a wrong form",
    "#AABBDD BB out of range",
    "#AABBDD group that the model does not have",
    "#AABBDD group's data beyond its channels",
    "#AABBDD channel that the model does not have",
    "#AABBDD single DD out of range",
    "#AABBDD blocked by the timeout status",
    "#AAN",
    "#AAN refused",
    "$AA2",
    "$002 in INIT mode",
    "$AA4",
    "$AA4 again",
    "$AA4 without a sample",
    "$AA5",
    "$AA5 again",
    "$AA6",
    "$AAF",
    "$AAM",
    "$AAC",
    "$AAC on a model without inputs",
    "$AACN",
    "$AACN refused",
    "$AALS 0",
    "$AALS 1",
    "$AALS on a model without inputs",
    "$AALS refused",
    "$AAP ASCII",
    "$AAP Modbus",
    "$AAP on a model without Modbus",
    "$AAPN 0",
    "$AAPN 1",
    "$AAPN out of range",
    "$AAPN without permission",
    "$AAPN 1 with a stored address outside 01-F7",
    "$ unknown command",
    "@AA",
    "@AA(Data) of 1",
    "@AA(Data) of 2",
    "@AA(Data) of 4",
    "@AA(Data) with a wrong form",
    "@AA(Data) beyond the last channel",
    "@AA(Data) on a model without outputs",
    "@AA(Data) blocked by the timeout status",
    "~AAO(Data) of 1",
    "~AAO(Data) of 2",
    "~AAO(Data) of 3",
    "~AAO(Data) of 4",
    "~AAO(Data) of 5",
    "~AAO(Data) of 6",
    "~AAO(Data) of 7",
    "~AAO(Data) with a wrong length",
    "~AAO(Data) with a character outside 0x20-0x7E",
    "~**",
    "~** restarts the host watchdog",
    "~AA0 00",
    "~AA0 04",
    "~AA0 80",
    "~AA0 84",
    "~AA1",
    "~AA1 clears",
    "~AA2",
    "~AA3EVV enables",
    "~AA3EVV enables while the status is set",
    "~AA3EVV restarts",
    "~AA3EVV disables",
    "~AA3EVV with a wrong form",
    "~AA3EVV VV out of range",
    "~AA4V P",
    "~AA4V S",
    "~AA4V on a model without outputs",
    "~AA4V refused",
    "~AA5V P",
    "~AA5V S",
    "~AA5V on a model without outputs",
    "~AA5V refused",
    "~ unknown command",
    // wire.md 5
    "counter wraps after 99999",
    "counter wraps after 65535",
    // wire.md 6
    "reset starts the host watchdog",
    "host watchdog expires",
    "host watchdog expires again",
    // wire.md 7
    "Modbus frame too short",
    "Modbus frame too long",
    "CRC wrong",
    "Modbus frame spoiled",
    "turn-around 00 before a Modbus frame",
    "Modbus frame for another address",
    "Modbus exception reply",
    "host OK by FC03",
    "host OK by FC04",
    "broadcast host OK by FC03",
    "broadcast host OK by FC04",
    "broadcast FC05",
    "broadcast FC06",
    "broadcast FC0F",
    "broadcast FC10",
    "broadcast ignored: not a write",
    "broadcast ignored: configuration",
    "broadcast refused",
    "unknown function",
    "FC01 coil 0x0000",
    "FC01 coil 0x0080",
    "FC01 coil 0x00A0",
    "FC01 coil 0x0020",
    "FC01 coil 0x0040",
    "FC01 coil 0x0060",
    "FC01 coil 0x0100",
    "FC01 coil 0x0104",
    "FC01 coil 0x010D",
    "FC01 02",
    "FC01 03 length",
    "FC01 03 quantity",
    "FC02",
    "FC02 on a model without inputs",
    "FC02 02",
    "FC02 03 length",
    "FC02 03 quantity",
    "FC03 counter",
    "FC03 0x01E2",
    "FC03 0x01E3",
    "FC03 0x01E4",
    "FC03 0x01E5",
    "FC03 0x01E8",
    "FC03 02",
    "FC03 03 length",
    "FC03 03 quantity",
    "FC04 counter",
    "FC04 02",
    "FC04 03 length",
    "FC04 03 quantity",
    "FC05 coil 0x0000",
    "FC05 coil 0x0080",
    "FC05 coil 0x00A0",
    "FC05 coil 0x0100",
    "FC05 coil 0x0104",
    "FC05 coil 0x0107",
    "FC05 coil 0x010D",
    "FC05 coil 0x0200",
    "FC05 02",
    "FC05 03 length",
    "FC05 03 neither FF00 nor 0000",
    "FC05 03 coil 0x0104",
    "FC05 03 coil 0x0107",
    "FC05 03 coil 0x010D",
    "FC05 03 coil 0x0200",
    "FC05 04 coil 0x0000",
    "FC05 04 coil 0x0080",
    "FC05 04 coil 0x00A0",
    "FC06 0x01E4",
    "FC06 0x01E5",
    "FC06 0x01E8",
    "FC06 0x01E8 restarts",
    "FC06 02",
    "FC06 03 length",
    "register 0x01E4 03",
    "register 0x01E5 03",
    "register 0x01E5 8N1",
    "register 0x01E8 03",
    "register 0x01E8 03 value 0 while enabled",
    "FC08 00",
    "FC08 0A",
    "FC08 0B",
    "FC08 0C",
    "FC08 0D",
    "FC08 0E",
    "FC08 0F",
    "FC08 12",
    "FC08 01",
    "FC08 03 length",
    "FC08 03 data",
    "FC0F coil 0x0000",
    "FC0F coil 0x0080",
    "FC0F coil 0x00A0",
    "FC0F coil 0x0200",
    "FC0F 02",
    "FC0F 03 length",
    "FC0F 03 quantity",
    "FC0F 03 byte count",
    "FC0F 04 coil 0x0000",
    "FC0F 04 coil 0x0080",
    "FC0F 04 coil 0x00A0",
    "FC10 0x01E4",
    "FC10 0x01E4 and 0x01E5",
    "FC10 0x01E5",
    "FC10 0x01E8",
    "FC10 0x01E8 restarts",
    "FC10 02",
    "FC10 03 length",
    "FC10 03 quantity",
    "FC10 03 byte count",
    "FC11",
    "FC11 03 length",
    "FC2B code 01",
    "FC2B code 02",
    "FC2B code 03",
    "FC2B code 04",
    "FC2B 01",
    "FC2B 02",
    "FC2B 03 length",
    "FC2B 03 code",
    "FC46 00",
    "FC46 04",
    "FC46 02",
    "FC46 03 length",
    "FC46 03 range",
    "FC46 03 reserved",
};

/// Rules that only a module with extensions applies: wire.md 12.
const char* const kExtensionRules[] = {
    // wire.md 2
    "reset into 8N2",
    "reset into 8E1",
    "reset into 8O1",
    // wire.md 4
    "%AANNTTCCFF CC with a line format out of range",
    "%AANNTTCCFF without permission for another line format",
    "%AANNTTCCFF 8N2",
    "%AANNTTCCFF 8E1",
    "%AANNTTCCFF 8O1",
    "~AARD",
    "~AARDVV",
    "~AARD with a wrong form",
    "~AARDVV out of range",
    "~AAXRRRR low word",
    "~AAXRRRRVVVV blocked by the timeout status",
    "~AAXRRRRVVVV to a read-only register",
    "~AAX register that the model does not have",
    "~AAX with a wrong form",
    // wire.md 7
    "broadcast ignored: extension register",
    "broadcast to timed outputs",
    "FC01 coil 0x08CA",
    "FC05 coil 0x08CA",
    "register 0x01E5 03 with a line format",
    "register 0x01E5 8N2",
    "register 0x01E5 8E1",
    "register 0x01E5 8O1",
    "register 0x0280 04",
    "FC10 several rows of extension registers",
    // wire.md 5, 6 and 12
    "the input filter accepts the level",
    "level too short for the input filter",
    "pulse too short for the input filter",
    "pulse restarts the time of the input filter",
    "new time of the input filter is over",
    "new time of the input filter runs",
    "inversion changes",
    "inversion stays",
    "timed output starts",
    "timed output of 0",
    "timed output ends",
    "command ends a timed output",
    "host watchdog ends a timed output",
    "reset ends a timed output",
    "0x0280 reads the remaining time",
    "0x0280 reads 0",
    "~AA5V stores a timed output as off",
    "ASCII request restarts the host watchdog",
    "Modbus request restarts the host watchdog",
    "request does not start a host watchdog that does not run",
    "response delay",
    "no response delay in INIT mode",
    "0x0301 reads 1",
    "0x0301 reads 2",
    "0x0301 reads 4",
    "0x0304 reads 0",
    "0x0304 reads timeouts",
    "0x0305 reads 0",
    "0x0305 reads stores",
    "0x0306 reads 0",
    "0x0306 reads 4",
    "0x030E reads bad bytes",
    "ASCII tally 0x0308",
    "ASCII tally 0x0309",
    "ASCII tally 0x030A",
    "ASCII tally 0x030B",
    "ASCII tally 0x030C",
    "ASCII tally 0x030D",
    "ASCII tally 0x030E",
    "ASCII tally 0x030F",
    "Modbus tally 0x0308",
    "Modbus tally 0x0309",
    "Modbus tally 0x030A",
    "Modbus tally 0x030B",
    "Modbus tally 0x030C",
    "Modbus tally 0x030D",
    "Modbus tally 0x030E",
    "Modbus tally 0x030F",
};

}  // namespace

Rules::Rules(Extensions extensions) : list_(std::begin(kRules), std::end(kRules)) {
  if (extensions == Extensions::Present) {
    list_.insert(list_.end(), std::begin(kExtensionRules), std::end(kExtensionRules));
    for (const ExtensionRow& row : extension_rows(kModelRows[0])) {
      add_rules_of(row);
    }
  }
  for (const std::string& rule : list_) {
    counts_[rule] = 0;
  }
}

void Rules::add_rules_of(const ExtensionRow& row) {
  const std::string name = row.name;
  list_.insert(list_.end(), {"~AAXRRRR " + name, "FC03 " + name, "FC04 " + name});
  if (row.written) {
    list_.insert(list_.end(), {"~AAXRRRRVVVV " + name, "FC06 " + name, "FC10 " + name});
    if (row.highest < 0xFFFF) {
      list_.insert(list_.end(), {"~AAXRRRRVVVV " + name + " out of range", "register " + name + " 03"});
    }
  }
}

void Rules::reached(const std::string& rule) {
  const auto found = counts_.find(rule);
  if (found == counts_.end()) {
    throw std::logic_error(
        "'" + rule +
        "': not in the list of rules of this module; add the rule to kRules or kExtensionRules; "
        "if it is in kExtensionRules, a module without extensions must not apply it");
  }
  ++found->second;
}

std::vector<std::string> Rules::missing() const {
  std::vector<std::string> missing;
  for (const std::string& rule : list_) {
    if (counts_.at(rule) == 0) {
      missing.push_back(rule);
    }
  }
  return missing;
}

std::string Rules::table() const {
  std::string table;
  for (const std::string& rule : list_) {
    const std::string count = std::to_string(counts_.at(rule));
    table += std::string(count.size() < 10 ? 10 - count.size() : 0, ' ') + count + "  " + rule + "\n";
  }
  return table;
}

}  // namespace ex9000::reference
