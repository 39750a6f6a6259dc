"""The requests whose instructions are counted: a list for each protocol, which depends on the features of the model."""

import collections

# How a request ends.
REPLY = "reply"
STORE = "store"  # a reply, after the value is stored
DONE = "done"  # no reply
IGNORED = "ignored"  # addressed to another module

Model = collections.namedtuple("Model", "name inputs outputs modbus")


class Request:
    """A request to repeat. Each pass sends one of the `frames`, in turn. Before each pass, the session sends the frames
    of `before`, which it does not count. If `before` and `frames` have the same number of frames, and this number is
    greater than 1, the session sends only one frame of `before` before each pass, in turn. A request that changes a
    stored value has several frames, or frames in `before`, so that the value changes in each pass. `settles`: how long
    the session waits after `before`, in seconds. `passes`: the maximum number of passes."""

    def __init__(
        self,
        name,
        frames,
        until=REPLY,
        before=(),
        settles=0.0,
        init=False,
        passes=100,
    ):
        self.name = name
        self.frames = frames
        self.until = until
        self.before = before
        self.settles = settles
        self.init = init  # INIT* is asserted
        self.passes = passes


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0xA001 if crc & 1 else crc >> 1
    return crc.to_bytes(2, "little")


def rtu(text):
    data = bytes.fromhex(text)
    return data + crc16(data)


def dcon(text, checksum):
    data = text.encode()
    return data + (f"{sum(data) & 0xFF:02X}" if checksum else "").encode() + b"\r"


def modbus_requests(model, general):
    """Returns requests for the functions of firmware/modbus/functions.hpp, with up to 4 registers or 13 coils each. The
    module has address 01. With `general`, also returns the requests that are the same for all models."""

    def request(name, *frames, before=(), **rest):
        return Request(
            name, [rtu(frame) for frame in frames], before=[rtu(frame) for frame in before], **rest
        )

    requests = []
    if model.outputs:
        requests += [
            request("01 read 13 outputs", "01 01 0000 000D"),
            request("01 read 13 safe values", "01 01 0080 000D"),
            request("01 read 13 power-on values", "01 01 00A0 000D"),
            request("05 output 0", "01 05 0000 FF00", "01 05 0000 0000"),
            request("05 output 12", "01 05 000C FF00", "01 05 000C 0000"),
            request("05 safe value", "01 05 0080 FF00", "01 05 0080 0000", until=STORE),
            request("05 power-on value", "01 05 00A0 FF00", "01 05 00A0 0000", until=STORE),
            request("0F 13 outputs", "01 0F 0000 000D 02 5515", "01 0F 0000 000D 02 AA0A"),
            request("0F 13 safe values", "01 0F 0080 000D 02 5515", "01 0F 0080 000D 02 AA0A", until=STORE),
            request(
                "0F 13 power-on values", "01 0F 00A0 000D 02 5515", "01 0F 00A0 000D 02 AA0A", until=STORE
            ),
        ]
    if model.inputs:
        requests += [
            request("01 read 8 inputs", "01 01 0020 0008"),
            request("01 read 8 latches high", "01 01 0040 0008"),
            request("01 read 8 latches low", "01 01 0060 0008"),
            request("02 read 8 inputs", "01 02 0000 0008"),
            request("03 read 4 counters", "01 03 0000 0004"),
            request("04 read 4 counters", "01 04 0000 0004"),
            request("05 clear latches", "01 05 0107 FF00"),
            request("05 clear counter 7", "01 05 0207 FF00"),
            request("0F clear 8 counters", "01 0F 0200 0008 01 FF"),
        ]
    running = ["01 06 01E8 00FF", "01 05 0104 FF00"]
    last = []
    if model.outputs:
        last.append(
            request("01 read 13 outputs, host watchdog running", "01 01 0000 000D", before=running)
        )
    if model.inputs:
        last.append(request("02 read 8 inputs, host watchdog running", "01 02 0000 0008", before=running))
    if not general:
        return requests + last
    return (
        requests
        + [
            request("01 read protocol", "01 01 0100 0001"),
            request("01 read watchdog enable", "01 01 0104 0001"),
            request("01 read timeout status", "01 01 010D 0001"),
            request("03 read code, address, baud rate", "01 03 01E2 0004"),
            request("03 read watchdog timeout", "01 03 01E8 0001"),
            request("05 protocol", "01 05 0100 0000", "01 05 0100 FF00", until=STORE),
            request("05 clear timeout status, already clear", "01 05 010D FF00"),
            request("06 address", "01 06 01E4 0005", "01 06 01E4 0001", until=STORE),
            request("06 address, no change", "01 06 01E4 0001"),
            request("06 baud rate", "01 06 01E5 0006", "01 06 01E5 000A", until=STORE),
            request("06 watchdog timeout", "01 06 01E8 00FE", "01 06 01E8 00FF", until=STORE),
            request("08 00 echo", "01 08 0000 A537"),
            request("08 0A clear counters", "01 08 000A 0000"),
            request("08 0B bus messages", "01 08 000B 0000"),
            request("08 0E server messages", "01 08 000E 0000"),
            request("08 12 overruns", "01 08 0012 0000"),
            request(
                "10 address and baud rate",
                "01 10 01E4 0002 04 0005 0006",
                "01 10 01E4 0002 04 0001 000A",
                until=STORE,
            ),
            request("10 watchdog timeout", "01 10 01E8 0001 02 00FE", "01 10 01E8 0001 02 00FF", until=STORE),
            request("11 report server id", "01 11"),
            request("2B 0E 01 basic identification", "01 2B 0E 01 00"),
            request("2B 0E 02 regular identification", "01 2B 0E 02 00"),
            request("2B 0E 04 longest object", "01 2B 0E 04 04"),
            request("46 00 module code", "01 46 00"),
            request("46 04 address", "01 46 04 05 000000", "01 46 04 01 000000", until=STORE),
            request("exception 01", "01 07 00"),
            request("exception 02", "01 03 1234 0001"),
            request("exception 03", "01 03 01E4 0000"),
            request("03 host OK", "01 03 3038 0000", until=DONE),
            request("broadcast host OK", "00 03 3038 0000", until=DONE),
            request("for another address", "05 01 0000 000D", until=IGNORED),
            request(
                "05 clear timeout status",
                "01 05 010D FF00",
                until=STORE,
                passes=10,
                settles=0.25,
                before=["01 10 01E8 0001 02 0001", "01 05 0104 FF00"],
            ),
            request(
                "05 watchdog enable",
                "01 05 0104 FF00",
                "01 05 0104 0000",
                until=STORE,
                before=["01 06 01E8 00FF"],
            ),
        ]
        + last
    )


def ascii_requests(model, general, checksum):
    """Returns requests with commands of firmware/dcon/commands.hpp. `checksum`: whether they have checksums. See
    modbus_requests."""

    def request(name, *commands, before=(), **rest):
        return Request(
            name,
            [dcon(command, checksum) for command in commands],
            before=[dcon(command, checksum) for command in before],
            **rest,
        )

    rising, falling, no_checksum = ("C0", "40", "00") if checksum else ("80", "00", "40")
    requests = []
    if general:
        requests += [
            request("%AANNTTCCFF counter edge", f"%0101400A{rising}", f"%0101400A{falling}", until=STORE),
            request("%AANNTTCCFF address", f"%0102400A{falling}", f"%0201400A{falling}", until=STORE),
            request(
                "%AANNTTCCFF baud rate and checksum",
                f"%01014006{no_checksum}",
                f"%0101400A{falling}",
                until=STORE,
                init=True,
            ),
            request("%AANNTTCCFF, no change", f"%0101400A{falling}"),
            request("#**", "#**", until=DONE),
            request("$AA2", "$012"),
            request("$AA4", "$014", before=["#**"]),
            request("$AA5", "$015"),
            request("$AA6", "$016"),
            request("$AAF", "$01F"),
            request("$AAM", "$01M"),
            request("@AA", "@01"),
            request("~AAO(Name)", "~01Oabcdef", "~01Oghijkl", until=STORE),
            request("~**", "~**", until=DONE),
            request("~AA0", "~010"),
            request("~AA1, timeout status already clear", "~011"),
            request("~AA2", "~012"),
            request("~AA3EVV", "~0130FE", "~0130FF", until=STORE),
            request("refused", "$01Z"),
            request("for another address", "$052", until=IGNORED),
            request("~AA1", "~011", until=STORE, before=["~013101"], settles=0.25, passes=10),
        ]
    if model.outputs:
        values = ["@011555", "@010AAA"] if model.outputs > 8 else ["@0155", "@01AA"]
        requests += [
            request("#AABBDD a group", "#010055", "#0100AA"),
            request("#AABBDD one output", "#011701", "#011700"),
            request("@AA(Data)", *values),
            request("~AA4V", "~014P", "~014S"),
            request("~AA5V power-on value", "~015P", "~015P", until=STORE, before=values),
            request("~AA5V safe value", "~015S", "~015S", until=STORE, before=values),
        ]
    if model.inputs:
        requests += [
            request("#AAN", "#017"),
            request("$AAC", "$01C"),
            request("$AACN", "$01C7"),
            request("$AALS", "$01L1", "$01L0"),
        ]
    if model.modbus:
        requests += [
            request("$AAP", "$01P"),
            request("$AAPN", "$01P1", "$01P0", until=STORE, init=True),
        ]
    requests.append(request("$AA6, host watchdog running", "$016", before=["~0131FF"]))
    return requests
