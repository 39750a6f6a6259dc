"""Tests send-update with modules that these tests simulate."""

from __future__ import annotations

import contextlib
import io
import os
import pathlib
import pty
import socket
import struct
import sys
import tempfile
import threading
import tty
import unittest
from unittest import mock
from zlib import crc32

from fake_module import COMPLETE, FLASH_FAILED, NONE, TAKEN_BACK, UNCONFIRMED, FakeModule, FakePort, with_crc

TOOLCHAIN = pathlib.Path(__file__).resolve().parents[2] / "toolchain"
sys.path.insert(0, str(TOOLCHAIN))

from send_update import main, modbus, ports  # noqa: E402
from send_update.progress import Progress  # noqa: E402
from update_file import Info, update_of  # noqa: E402

IMAGE = bytes(range(250)) * 40  # 79 blocks, the last one in part
FILE = update_of(Info("9042DM.pico", len(IMAGE), 0x0123, 1, crc32(IMAGE)), IMAGE).packed()
RUNS = "runs D01.23, which it confirms after 60 s"


def is_block(frame: bytes, offset: int) -> bool:
    return frame[1:3] == b"\x10\x20" and frame[7:11] == offset.to_bytes(4, "big")


class Session(unittest.TestCase):
    """Runs send-update with FILE."""

    def setUp(self) -> None:
        file = tempfile.NamedTemporaryFile(suffix=".ex9fw")
        self.addCleanup(file.close)
        file.write(FILE)
        file.flush()
        self.file = file.name

    def call(self, port: str, *words: str, file: str = "") -> tuple[int, str, str]:
        """Returns the exit status, the standard output and the standard error."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main.main([port, file or self.file, *words])
            except SystemExit as error:
                status = int(error.code or 0)
        return status, out.getvalue(), err.getvalue()

    def send(self, port: FakePort, *words: str) -> tuple[int, str, str]:
        with mock.patch.object(main, "serial_port", return_value=port):
            return self.call("a port", *words)

    def succeeds(self, port: FakePort, *words: str, result: str = RUNS) -> None:
        names = [word for word in words if word != "--wait"]
        expected = "".join(f"{name}: {result}\n" for name in names)
        self.assertEqual(self.send(port, *words)[:2], (0, expected))
        for module in port.modules:
            self.assertEqual(module.image, IMAGE.ljust(79 * 128, b"\xff"))

    def fails(self, port: FakePort, *words: str, result: str) -> None:
        status, out, _ = self.send(port, *(words or ("5",)))
        self.assertRegex(out, result)
        self.assertEqual(status, 1)


class OneModule(Session):
    def test_a_module_gets_the_blocks_of_the_file_and_starts_the_image(self) -> None:
        module = FakeModule()
        self.succeeds(FakePort(module), "5")
        self.assertEqual(module.begins, [FILE[:18] + bytes(2) + FILE[20:32]])  # without the flag
        self.assertEqual(module.blocks, list(range(0, 79 * 128, 128)))
        self.assertEqual((module.state, module.version), (UNCONFIRMED, 0x0123))

    def test_it_is_reached_by_serial_number(self) -> None:
        port = FakePort(FakeModule(), FakeModule(serial_number=b"\x0d\x00\x00\x01"))
        port.modules[1].image = IMAGE.ljust(79 * 128, b"\xff")
        self.succeeds(port, "0D001F3A")
        self.assertEqual({frame[:7] for frame in port.sent}, {b"\xfd\x46\x08\x0d\x00\x1f\x3a"})
        self.assertEqual(port.modules[1].blocks, [])

    def test_wait_waits_until_the_module_has_confirmed_the_image(self) -> None:
        module = FakeModule()
        self.succeeds(FakePort(module), "5", "--wait", result="runs D01.23, confirmed")
        self.assertEqual(module.state, NONE)
        module = FakeModule()
        module.confirms = False
        self.fails(FakePort(module), "5", "--wait", result="has not confirmed .* in the state 4 .unconfirmed.")

    def test_an_interrupted_transfer_continues(self) -> None:
        def interrupt(frame: bytes, reply: bytes) -> bytes:
            if is_block(frame, 40 * 128):
                raise KeyboardInterrupt
            return reply

        module = FakeModule()
        status, out, err = self.send(FakePort(module, fault=interrupt), "5")
        self.assertEqual((status, out), (130, ""))
        self.assertRegex(err, "stopped: the modules keep what they have received; the same command continues\n$")
        self.succeeds(FakePort(module), "5")
        self.assertEqual(module.blocks, list(range(0, 79 * 128, 128)))

    def test_a_module_that_has_all_blocks_only_activates(self) -> None:
        module = FakeModule()
        module.info = FILE[:18] + bytes(2) + FILE[20:32]
        module.image = IMAGE.ljust(79 * 128, b"\xff")
        module.state = COMPLETE
        self.succeeds(FakePort(module), "5")
        self.assertEqual(module.blocks, [])


class Faults(Session):
    def lose(self, which, times: int, request_too: bool = False) -> FakePort:
        """Returns a port that loses the first replies to some requests, or these requests."""
        left = times

        class Port(FakePort):
            def send(self, frame: bytes) -> None:
                nonlocal left
                if not which(frame) or left == 0:
                    super().send(frame)
                    return
                left -= 1
                if not request_too:
                    self.reply(frame)

        return Port(FakeModule())

    def test_each_request_is_repeated_three_times(self) -> None:
        for name, begin in (("signature", "050301220"), ("begin", "05101000"), ("block", "0510200000448800000080")):
            for request_too in (False, True):
                with self.subTest(name, request_too=request_too):
                    def which(frame: bytes, begin: str = begin) -> bool:
                        return frame.hex().startswith(begin)
                    self.succeeds(self.lose(which, 3, request_too), "5")
                    port = self.lose(which, 4, request_too)
                    self.fails(port, result="5: FAILED: gives no reply; check")

    def test_an_activation_survives_a_lost_request_and_a_lost_reply(self) -> None:
        for request_too in (False, True):
            port = self.lose(lambda frame: frame.startswith(b"\x05\x06\x10\x13"), 1, request_too)
            self.succeeds(port, "5")
            self.assertEqual(sum(frame[1] == 6 for frame in port.sent), request_too)

    def test_noise_and_echo_before_a_reply_are_skipped(self) -> None:
        self.succeeds(FakePort(FakeModule(), fault=lambda _, reply: b"\x00\x05\x03" + reply), "5")
        self.succeeds(FakePort(FakeModule(), fault=lambda request, reply: request + reply), "5")

    def test_a_damaged_reply_counts_as_none(self) -> None:
        self.fails(FakePort(FakeModule(), fault=lambda _, reply: reply[:-1] + b"x"), result="gives no reply")

    def test_a_line_that_is_never_silent_ends(self) -> None:
        class Noisy(FakePort):
            def receive(self, seconds: float) -> bytes:
                return b"\xff" * 20

        self.fails(Noisy(FakeModule()), result="gives no reply")

    def test_a_module_that_still_erases_gets_the_block_again(self) -> None:
        module = FakeModule()
        module.erasing = 30
        self.succeeds(FakePort(module), "5")
        self.assertEqual(module.blocks[:32], 31 * [0] + [128])
        module = FakeModule()
        module.erasing = 1000
        self.fails(FakePort(module), result=r"has not stored the block, and is in the state 1 \(receiving\); start")

    def test_a_flash_that_fails_is_reported(self) -> None:
        module = FakeModule()
        module.flash_fails_at = 256
        self.fails(FakePort(module), result=r"5: FAILED: has not stored .* in the state 6 \(flash failed\); start")
        self.assertEqual((module.state, module.blocks), (FLASH_FAILED, [0, 128, 256]))

    def test_an_image_that_is_wrong_in_the_module_is_reported(self) -> None:
        module = FakeModule()

        def damage(frame: bytes, reply: bytes) -> bytes:
            if is_block(frame, 128):
                module.image = bytes(256)
            return reply

        self.fails(FakePort(module, fault=damage), result=r"has not stored the block, and is in the state 0 \(none\)")

    def test_a_module_that_was_restarted_gets_the_begin_again(self) -> None:
        module = FakeModule()

        def restart(frame: bytes, reply: bytes) -> bytes:
            if is_block(frame, 40 * 128) and module.blocks.count(40 * 128) == 1:
                module.reset()
            return reply

        self.succeeds(FakePort(module, fault=restart), "5")
        self.assertEqual(module.blocks[39:45], [39 * 128, 40 * 128, 41 * 128, 32 * 128, 33 * 128, 34 * 128])
        self.assertEqual(len(module.begins), 2)

    def test_a_module_that_refuses_the_blocks_is_reported(self) -> None:
        module = FakeModule()

        def always_restart(_: bytes, reply: bytes) -> bytes:
            module.reset()
            return reply

        self.fails(FakePort(module, fault=always_restart), result="refuses its blocks; restart it")
        self.assertEqual(len(module.begins), 4)


class Refusals(Session):
    def refused(self, module: FakeModule, result: str) -> None:
        self.fails(FakePort(module), result=result)
        self.assertEqual(module.blocks, [])

    def test_a_file_for_another_module_is_refused_before_anything_is_sent(self) -> None:
        for signature in ("9042DM.picw", "9043DM.pico", ""):
            module = FakeModule(signature=signature)
            self.refused(module, f"has the signature '{signature}'; the file is for '9042DM.pico', an EX9042D-M on")
            self.assertEqual(module.begins, [])

    def test_a_module_without_slots_is_refused(self) -> None:
        module = FakeModule()
        module.has_slots = False
        self.refused(module, r"refuses to read the register 0x1010: exception 02 \(illegal data address\); its")

    def test_a_module_that_permits_no_updates_is_refused(self) -> None:
        module = FakeModule()
        module.allowed = False
        self.refused(module, "permits no updates; write 1 to register 0x0254")

    def test_a_module_that_refuses_the_begin_is_reported(self) -> None:
        def refuse(frame: bytes, reply: bytes) -> bytes:
            return with_crc(b"\x05\x90\x04") if frame[1:4] == b"\x10\x10\x00" else reply

        self.fails(FakePort(FakeModule(), fault=refuse), result=r"refuses the update: exception 04 \(server device")

    def test_other_refusals_are_reported(self) -> None:
        for begin, result in (
            (b"\x10\x20\x00", r"refuses the block at 0: exception 01 \(illegal function\); start again"),
            (b"\x06\x10\x13", r"refuses to activate the image: exception 01 \(illegal function\); start again"),
        ):
            def refuse(frame: bytes, reply: bytes, begin: bytes = begin) -> bytes:
                return with_crc(bytes([5, frame[1] | 0x80, 1])) if frame[1:4] == begin else reply

            self.fails(FakePort(FakeModule(), fault=refuse), result=result)

    def test_an_image_that_is_not_complete_at_the_end_is_reported(self) -> None:
        module = FakeModule()

        def forget(frame: bytes, reply: bytes) -> bytes:
            if is_block(frame, 78 * 128):
                module.state = NONE
            return reply

        self.fails(FakePort(module, fault=forget), result="has all blocks, but not a complete image; start again")

    def test_an_image_on_trial_is_left_alone(self) -> None:
        module = FakeModule()
        module.state = UNCONFIRMED
        self.refused(module, "still tries an image; start again in a minute")
        self.assertEqual(module.begins, [])

    def test_an_image_that_is_taken_back_is_reported(self) -> None:
        module = FakeModule()
        module.takes_back = True
        self.fails(FakePort(module), result="has taken the image back and runs D01.00: it did not prove itself")
        self.assertEqual(module.state, TAKEN_BACK)
        module = FakeModule()

        def take_back_later(frame: bytes, reply: bytes) -> bytes:
            if module.state == UNCONFIRMED and frame[2:4] == b"\x03\x00":  # after the first look at the version
                module.state, module.version = TAKEN_BACK, 0x0100
            return reply

        self.fails(FakePort(module, fault=take_back_later), "5", "--wait", result="has taken the image back and runs")

    def test_a_module_that_runs_another_version_afterwards_is_reported(self) -> None:
        module = FakeModule()

        def forget(_: bytes, reply: bytes) -> bytes:
            if module.state == UNCONFIRMED:
                module.version = 0x0100
            return reply

        self.fails(FakePort(module, fault=forget), result=r"runs D01.00 and not D01.23, in the state 4 \(unconfirmed\)")

    def test_a_module_that_does_not_come_back_is_reported(self) -> None:
        module = FakeModule()
        module.reset_lasts = 1000
        self.fails(FakePort(module), result="gives no reply any more; start again when it answers")


class SeveralModules(Session):
    def test_they_activate_together_when_all_have_the_image(self) -> None:
        modules = (FakeModule(5), FakeModule(6), FakeModule(7, b"\x0d\x00\x00\x01"))
        port = FakePort(*modules)
        self.succeeds(port, "5", "6", "0D000001", "--wait", result="runs D01.23, confirmed")
        activations = [place for place, frame in enumerate(port.sent) if b"\x06\x10\x13\x00\x01" in frame[1:]]
        self.assertEqual(activations, list(range(activations[0], activations[0] + 3)))

    def test_nothing_is_sent_if_one_cannot_get_it(self) -> None:
        modules = (FakeModule(5), FakeModule(6, signature="9043DM.pico"))
        result = "5: not updated, because another module has failed: nothing has been sent\n6: FAILED: has the"
        self.fails(FakePort(*modules), "5", "6", result=result)
        self.assertEqual(modules[0].begins, [])

    def test_none_activates_if_one_has_not_received_all(self) -> None:
        modules = (FakeModule(5), FakeModule(6), FakeModule(7))
        modules[1].flash_fails_at = 0
        result = "5: not updated, .* same command continues\n6: FAILED: has not stored.*\n7: not updated,"
        self.fails(FakePort(*modules), "5", "6", "7", result=result)
        self.assertEqual([module.state for module in modules], [COMPLETE, FLASH_FAILED, COMPLETE])
        modules[1].flash_fails_at = -1
        self.succeeds(FakePort(*modules), "5", "6", "7")

    def test_the_result_of_each_is_reported(self) -> None:
        modules = (FakeModule(5), FakeModule(6))
        modules[0].takes_back = True
        self.fails(FakePort(*modules), "5", "6", result=f"^5: FAILED: has taken .*\n6: {RUNS}\n$")


class Ports(Session):
    """The program with a real pseudo-terminal and real sockets. The modules restart at once, so no pause is needed."""

    def setUp(self) -> None:
        super().setUp()
        patch = mock.patch("send_update.ports.Port.pause")
        patch.start()
        self.addCleanup(patch.stop)

    def serve(self, module: FakeModule, read, write, modbus_tcp: bool = False) -> None:
        """Answers requests until `read` fails or returns nothing."""
        module.reset_lasts = 0
        port = FakePort(module)
        received = b""
        with contextlib.suppress(OSError):
            while data := read(4096):
                received += data
                if modbus_tcp and len(received) == 6 + int.from_bytes(received[4:6], "big"):
                    pdu = module.reply(received[7:])
                    write(received[:4] + struct.pack(">HB", 1 + len(pdu), received[6]) + pdu)
                elif not modbus_tcp and len(received) >= 8 and with_crc(received[:-2]) == received:
                    write(port.reply(received))
                else:
                    continue
                received = b""
                port.pause(0)

    def start(self, target) -> None:
        thread = threading.Thread(target=target, daemon=True)
        thread.start()
        self.addCleanup(thread.join, 10)  # it ends when the program has closed the port

    def listen(self, module: FakeModule, modbus_tcp: bool) -> int:
        """Returns the TCP port of a server for one connection."""
        server = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(server.close)

        def accept() -> None:
            with server.accept()[0] as connection:
                self.serve(module, connection.recv, connection.sendall, modbus_tcp)

        self.start(accept)
        return server.getsockname()[1]

    def test_a_serial_port(self) -> None:
        master, slave = pty.openpty()
        tty.setraw(slave)
        path = os.ttyname(slave)
        module = FakeModule()
        self.addCleanup(os.close, master)
        self.start(lambda: self.serve(module, lambda size: os.read(master, size), lambda data: os.write(master, data)))
        self.addCleanup(os.close, slave)
        status, out, err = self.call(path, "5", "--baud", "115200")
        self.assertEqual((status, out), (0, f"5: {RUNS}\n"), err)
        self.assertEqual(module.version, 0x0123)

    def test_rtu_frames_over_tcp(self) -> None:
        module = FakeModule()
        port = self.listen(module, modbus_tcp=False)
        done = self.call(f"tcp:127.0.0.1:{port}", "0D001F3A", "--baud", "115200")
        self.assertEqual(done[:2], (0, f"0D001F3A: {RUNS}\n"))

    def test_modbus_tcp(self) -> None:
        module = FakeModule()
        port = self.listen(module, modbus_tcp=True)
        self.assertEqual(self.call(f"modbus-tcp:127.0.0.1:{port}", "5")[:2], (0, f"5: {RUNS}\n"))

    def test_a_port_that_is_not_there_is_reported_in_one_line(self) -> None:
        problem = "/missing: No such file or directory; name a serial port that is there and not in use"
        self.assertEqual(self.call("/missing", "5"), (1, "", f"send-update: {problem}\n"))
        server = socket.create_server(("127.0.0.1", 0))
        port = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        server.close()
        self.assertRegex(self.call(port, "5")[2], f"^send-update: {port}: .*refused; name a host and a port that .*\n$")

    def test_python3_serial_is_required_for_a_serial_port_only(self) -> None:
        with mock.patch.dict(sys.modules, {"serial": None}):
            problem = "port: python3-serial is missing; run toolchain/install-packages python3-serial"
            self.assertEqual(self.call("port", "5"), (1, "", f"send-update: {problem}\n"))

    def test_an_error_of_the_port_is_reported_in_one_line(self) -> None:
        ours, theirs = socket.socketpair()
        self.addCleanup(ours.close)
        self.addCleanup(theirs.close)
        theirs.sendall(b"x")
        broken = mock.Mock(side_effect=OSError("broken"))
        for port in (ports.Port(ours, broken, ours.sendall), ports.Port(ours, ours.recv, broken)):
            with mock.patch.object(port, "close"), mock.patch.object(main, "serial_port", return_value=port):
                done = self.call("port", "5")
            self.assertEqual(done, (1, "", "send-update: port: broken; connect it again (nothing has been sent)\n"))

    def test_a_port_that_goes_away_is_reported_in_one_line(self) -> None:
        server = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(server.close)
        port = f"tcp:127.0.0.1:{server.getsockname()[1]}"

        def accept_and_close() -> None:
            server.accept()[0].close()

        self.start(accept_and_close)
        status, out, err = self.call(port, "5")
        self.assertEqual((status, out), (1, ""))
        self.assertRegex(err, f"^send-update: {port}: .*; .* again \\(nothing has been sent\\)\n$")


class Transports(unittest.TestCase):
    def test_the_crc_is_that_of_the_specification(self) -> None:
        self.assertEqual(modbus.crc16(bytes.fromhex("01030000000A")), 0xCDC5)

    def test_modbus_tcp_skips_late_replies_and_takes_the_exception_of_a_gateway_as_no_reply(self) -> None:
        request = modbus.read(0x0300, 1)
        module = modbus.Module(modbus.ModbusTcp(port := mock.Mock()), modbus.target("5"))
        good = bytes.fromhex("0000000505") + bytes.fromhex("03020123")
        port.receive.side_effect = [b"\x00\x09" + good, b"\x00", b"\x01" + good[:-1], good[-1:]]
        self.assertEqual(module.ask(request, 1), b"\x01\x23")
        port.send.assert_called_once_with(bytes.fromhex("0001 0000 0006 05 03 0300 0001"))
        port.receive.side_effect = [bytes.fromhex("0002 0000 0003 05 83 0B")]
        with self.assertRaises(modbus.NoReply):
            module.ask(request, 1)
        port.receive.side_effect = [bytes.fromhex("0003 0000 0003 05 83 02")]  # what follows is late
        with self.assertRaisesRegex(modbus.Refused, r"exception 02 \(illegal data address\)"):
            module.ask(request, 1)
        port.receive.side_effect = [b"\x00\x03" + good, b""]
        with self.assertRaises(modbus.NoReply):
            module.ask(request, 1)


class Arguments(Session):
    def test_wrong_arguments_are_refused(self) -> None:
        for port, words, message in (
            ("tcp:host", ["5"], "tcp:host: expected tcp:HOST:PORT or modbus-tcp:HOST"),
            ("modbus-tcp:a:b", ["5"], "modbus-tcp:a:b: expected tcp:HOST:PORT"),
            ("modbus-tcp:host", ["5", "0D000001"], "0D000001: Modbus TCP cannot carry a request by serial number"),
            ("port", ["5", "05"], "5: is there twice"),
            ("port", ["0"], "0: expected 1 to 247, or 8 hex digits"),
            ("port", ["248"], "248: expected"),
            ("port", ["0D0001"], "0D0001: expected"),
            ("port", ["5", "--baud", "9601"], "invalid choice: 9601"),
            ("port", ["5", "--format", "7E1"], "invalid choice: '7E1'"),
            ("port", [], "required: MODULE"),
        ):
            with self.subTest(message):
                status, out, err = self.call(port, *words)
                self.assertEqual((status, out), (2, ""))
                self.assertIn(message, err)

    def test_a_wrong_file_is_reported_in_one_line(self) -> None:
        for file, problem in (
            ("/missing.ex9fw", "No such file or directory; name a file that you can read"),
            ("/dev/null", "has 0 bytes, not 32 and 136 for each block; build or copy it again"),
        ):
            self.assertEqual(self.call("port", "5", file=file), (1, "", f"send-update: {file}: {problem}\n"))


class ShownProgress(unittest.TestCase):
    def test_a_terminal_gets_a_bar_and_a_file_gets_lines(self) -> None:
        stream = io.StringIO()
        with Progress("5", stream) as show:
            for has in range(0, 101, 5):
                show(has, 100)
        self.assertEqual(stream.getvalue(), "".join(f"5: {tenth} % of 100 bytes\n" for tenth in range(0, 101, 10)))
        stream = io.StringIO()
        with mock.patch.object(stream, "isatty", return_value=True), Progress("5", stream) as show:
            show(50, 100)
        self.assertEqual(stream.getvalue(), f"\r5 [{'#' * 20}{' ' * 20}]  50 %\n")


if __name__ == "__main__":
    unittest.main()
