"""Tests what the panel's server accepts and rejects. During these tests, a master polls a module, and no poll may fail.
Also tests at which addresses and ports the server listens, how the simulator ends while pages are open, and what
happens if a page does not read."""

import json
import os
import pathlib
import random
import socket
import subprocess
import tempfile
import threading
import unittest

from simulator import HANG, PROGRAM, Master, Simulator, wait_until
from web_socket import Page, all_of, ask, open_socket, request, status, upgrade

MOST_PAGES = 16
MOST_REQUESTS = 64  # concurrent requests, in addition to the pages
TRY_AGAIN_LATER = 1013
LOOKS = 20  # states that one page receives while the server sends no message to another page, which does not read


class Polling:
    """A master that polls a module until `end` is called or a poll fails. `wrong` is the error of that poll."""

    def __init__(self, port):
        self._master = Master(port)
        self.wrong = None
        self._left = None  # remaining polls; None until end() is called
        self._thread = threading.Thread(target=self._poll)
        self._thread.start()

    def _poll(self):
        try:
            while self._left != 0:
                if self._master.ask("020200000008", 6)[:2] != b"\x02\x01":
                    raise AssertionError("poll: unexpected PDU; expected a PDU that begins with 02 01 (hex)")
                if self._left is not None:
                    self._left -= 1
        except Exception as wrong:  # pylint: disable=broad-exception-caught # tearDown reports it
            self.wrong = wrong

    def end(self):
        """Lets the thread carry out up to five more polls, waits until the thread ends, and closes the connection."""
        self._left = 5
        self._thread.join()
        self._master.close()


class Server(unittest.TestCase):
    def setUp(self):
        self.simulator = Simulator("EX9042D-M@01,baud=115200", "EX9052D-M@02,baud=115200", "--port", "tcp:0")
        self.addCleanup(self.simulator.close)
        self.port = self.simulator.port
        self.polling = Polling(self.simulator.lines[0])

    def tearDown(self):
        self.polling.end()
        self.assertIsNone(self.polling.wrong)

    def page(self):
        page = Page(self.port)
        self.addCleanup(page.close)
        self.assertEqual(page.status, 101)
        return page

    def expect(self, wanted, data):
        answer = ask(self.port, data)
        self.assertEqual(status(answer), wanted, (data[:200], answer[:200]))
        return answer

    def test_the_page_has_security_headers_and_localhost_is_accepted(self):
        for target, kind in ("/", b"text/html"), ("/panel.css", b"text/css"), ("/panel.js", b"text/javascript"):
            answer = self.expect(200, request(self.port, target))
            for part in (kind, b"Content-Security-Policy: default-src 'self'", b"Cache-Control: no-store",
                         b"X-Content-Type-Options: nosniff"):
                self.assertIn(part, answer)
        self.expect(200, request(self.port, host=f"localhost:{self.port}"))

    def test_models_json_is_the_output_of_describe(self):
        answer = self.expect(200, request(self.port, "/models.json"))
        printed = subprocess.run([PROGRAM, "describe", "--format", "json"], stdout=subprocess.PIPE, check=True).stdout
        self.assertEqual(json.loads(answer.partition(b"\r\n\r\n")[2]), json.loads(printed))

    def test_a_wrong_missing_or_second_host_is_refused(self):
        for host in ("example.org", f"example.org:{self.port}", "127.0.0.1.example.org", False,
                     f"127.0.0.1:{self.port}.example.org"):
            self.expect(403, request(self.port, host=host))
            self.expect(403, upgrade(self.port, host=host))
        self.expect(403, request(self.port, headers=["Host: example.org"]))

    def test_a_browser_behind_a_tunnel_with_another_port_is_served(self):
        for host in "localhost:8080", "127.0.0.1:8080", "localhost":
            self.expect(200, request(self.port, host=host, headers=[f"Origin: http://{host}"]))
            with open_socket(self.port) as page:
                page.sendall(upgrade(self.port, host=host, origin=f"http://{host}"))
                self.assertEqual(status(page.recv(12)), 101)
            self.expect(403, upgrade(self.port, host=host, origin="http://localhost:3000"))

    def test_another_origin_and_a_web_socket_without_an_origin_are_refused(self):
        for origin in ("http://example.org", "null", f"https://127.0.0.1:{self.port}",
                       f"http://127.0.0.1:{self.port}.example.org", "http://127.0.0.1"):
            self.expect(403, request(self.port, headers=[f"Origin: {origin}"]))
            self.expect(403, upgrade(self.port, origin=origin))
        self.expect(403, upgrade(self.port, origin=None))
        self.expect(403, request(self.port, "/live"))

    def test_a_sec_fetch_site_with_a_value_other_than_same_origin_or_none_is_refused(self):
        for site in "cross-site", "same-site", "nonsense":
            self.expect(403, request(self.port, headers=[f"Sec-Fetch-Site: {site}"]))
            twice = ["Sec-Fetch-Site: none", f"Sec-Fetch-Site: {site}"]
            self.expect(403, request(self.port, "/panel.js", headers=twice))
            self.expect(403, upgrade(self.port, headers=[f"Sec-Fetch-Site: {site}"]))
        for site in "same-origin", "none":
            self.expect(200, request(self.port, headers=[f"Sec-Fetch-Site: {site}"]))

    def test_unknown_paths_unsupported_methods_bodies_and_live_without_an_upgrade_are_refused(self):
        for target in ("/nothing", "/../etc/passwd", "/panel.js?x", "//", "http://example.org/"):
            self.expect(404, request(self.port, target))
        for method in "POST", "PUT", "DELETE", "OPTIONS", "FOO":
            answer = self.expect(405, request(self.port, method=method))
            self.assertIn(b"\r\nAllow: GET, HEAD\r\n", answer)
            with_body = request(self.port, method=method, headers=["Content-Length: 10"]) + b"0123456789"
            self.expect(405, with_body)
        self.expect(426, request(self.port, "/live", headers=[f"Origin: http://127.0.0.1:{self.port}"]))
        for method in "GET", "HEAD":
            self.expect(413, request(self.port, method=method, headers=["Content-Length: 10"]) + b"0123456789")

    def test_the_response_to_head_is_the_header_of_the_response_to_get(self):
        for target in "/", "/panel.js", "/nothing":
            header, body = ask(self.port, request(self.port, target)).split(b"\r\n\r\n", 1)
            self.assertNotEqual(body, b"")
            self.assertEqual(ask(self.port, request(self.port, target, method="HEAD")), header + b"\r\n\r\n")

    def test_malformed_and_too_long_requests_are_refused(self):
        self.expect(431, request(self.port, headers=["X: " + "x" * 10000]))
        self.expect(431, request(self.port, "/" + "x" * 20000))
        for garbage in (b"\0\1\2\3\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
                        random.Random(7).randbytes(3000) + b"\r\n\r\n",
                        b"GET / HTTP/1.1\r\nHost : x\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n"):
            self.expect(400, garbage)

    def test_a_connection_with_an_incomplete_request_is_closed_after_a_timeout(self):
        with open_socket(self.port) as silent, open_socket(self.port) as slow:
            slow.sendall(b"GET / HTTP/1.1\r\nHost:")
            for connection in silent, slow:
                self.assertEqual(all_of(connection), b"")

    def test_a_request_may_come_in_pieces(self):
        whole = request(self.port)
        with open_socket(self.port) as connection:
            # With smaller pieces, the request could take longer than 5 s, the timeout of the server.
            for at in range(0, len(whole) - 1, 16):
                connection.sendall(whole[at:min(at + 16, len(whole) - 1)])
                self.expect(200, request(self.port, "/panel.css"))  # so that the piece arrives separately
            connection.sendall(whole[-1:])
            self.assertEqual(status(all_of(connection)), 200)

    def test_an_extra_page_is_rejected_until_another_closes(self):
        pages = [self.page() for _ in range(MOST_PAGES)]
        another = self.page()
        self.assertIsNone(another.next())
        self.assertEqual(another.closed_with, TRY_AGAIN_LATER)
        another.close()
        self.expect(200, request(self.port, "/panel.js"))  # requests do not count as pages
        pages[0].close()
        wait_until(lambda: self.page().next())
        self.assertTrue(pages[1].tell("1 status")["ok"])
        for page in pages:
            page.close()

    def test_an_extra_request_is_rejected_and_disturbs_no_page(self):
        page = self.page()
        rounds = 0

        def again():
            """If the server accepts a request, carries out a round: opens MOST_REQUESTS connections, expects that the
            server rejects one more connection and still replies to the page, and closes the connections. Returns
            whether three rounds have passed."""
            nonlocal rounds
            if status(ask(self.port, request(self.port))) == 200:
                waiting = [open_socket(self.port) for _ in range(MOST_REQUESTS)]
                for connection in waiting:
                    self.addCleanup(connection.close)
                    connection.sendall(b"GET")
                self.expect(503, b"")
                self.assertTrue(page.tell("1 status")["ok"])
                for connection in waiting:
                    connection.close()
                rounds += 1
            return rounds == 3

        wait_until(again)

    def test_a_page_that_sends_an_invalid_message_is_disconnected(self):
        for text in ("garbage", "[]", "{}", '{"id":1}', '{"do":"list"}', '{"id":-1,"do":"list"}', '{"id":1,"do":2}',
                     '{"id":1,"do":"list","more":1}', "x" * 5000, json.dumps({"id": 1, "do": "x" * 2000}), b"\xff\xfe",
                     "[" * 4000):
            page = self.page()
            page.send(text)
            while page.next() is not None:
                pass
        page = self.page()
        page.connection.sendall(random.Random(8).randbytes(500))
        all_of(page.connection)
        binary = self.page()
        binary.send(b'{"id":1,"do":"list"}', opcode=2)
        while binary.next() is not None:
            pass

    def test_a_page_can_send_control_commands_but_not_quit(self):
        page = self.page()
        hello = page.next()["hello"]
        self.assertEqual([module["model"] for module in hello["modules"]], ["EX9042D-M", "EX9052D-M"])
        self.assertEqual(page.tell("2 input 3 on"), {"id": 1, "ok": True, "text": "ok"})
        self.assertEqual(page.tell("2 inputs", 7), {"id": 7, "ok": True, "text": "ok 0008"})
        self.assertEqual(page.tell("2 input 3 off")["ok"], True)
        self.assertFalse(page.tell("9 reset")["ok"])
        for command in "quit", "  quit", "quit now":
            self.assertFalse(page.tell(command)["ok"])
        self.assertTrue(page.tell("list")["ok"])

    def test_an_input_that_a_page_holds_is_released_when_the_connection_of_the_page_ends(self):
        page, another = self.page(), self.page()
        page.say("2 input 5 on", undo="2 input 5 off")
        self.assertTrue(page.until(lambda message: message.get("reply"))["reply"]["ok"])
        self.assertEqual(another.tell("2 inputs")["text"], "ok 0020")
        page.close()
        wait_until(lambda: another.tell("2 inputs")["text"] == "ok 0000")

    def test_the_server_answers_after_connections_that_end_early(self):
        for data in (b"GET", upgrade(self.port)[:-1], upgrade(self.port), request(self.port)):
            for _ in range(10):
                with open_socket(self.port) as connection:
                    connection.sendall(data)
        wait_until(lambda: status(ask(self.port, request(self.port))) == 200)


class Start(unittest.TestCase):
    def test_the_simulator_ends_without_an_error_while_pages_are_open(self):
        simulator = Simulator("EX9042D", "--port", "tcp:0")
        self.addCleanup(simulator.close)
        pages = [Page(simulator.port) for _ in range(3)]
        waiting = open_socket(simulator.port)
        for page in pages:
            self.assertTrue(page.tell("list")["ok"])
        simulator.process.terminate()
        self.assertEqual(simulator.process.wait(HANG), 0)
        for each in [*pages, waiting]:
            each.close()

    def test_a_port_in_use_is_refused_if_it_is_named_and_replaced_if_it_is_the_default(self):
        first = Simulator("EX9042D", "--port", "tcp:0")
        self.addCleanup(first.close)
        second = run("EX9042D", "--port", "tcp:0", "--panel", str(first.port))
        self.assertEqual(second.returncode, 1)
        self.assertEqual(
            second.stderr,
            f"ex9000-sim: --panel: {first.port}: the port is in use; name another port, or end the program that uses "
            "it\n",
        )
        usual = [Simulator("EX9042D", "--port", "tcp:0", panel=None) for _ in range(2)]
        for each in usual:
            self.addCleanup(each.close)
            self.assertEqual(status(ask(each.port, request(each.port))), 200)
        self.assertNotEqual(usual[0].port, usual[1].port)

    def test_the_server_listens_on_the_loopback_address_and_not_on_all_addresses(self):
        simulator = Simulator("EX9042D", "--port", "tcp:0")
        self.addCleanup(simulator.close)
        listening = [line.split()[1] for line in tcp_sockets() if line.split()[3] == "0A"]
        self.assertIn(f"0100007F:{simulator.port:04X}", listening)
        self.assertNotIn(f"00000000:{simulator.port:04X}", listening)

    @unittest.skipUnless(pathlib.Path("/proc/net/if_inet6").exists(), "this machine has no IPv6")
    def test_the_server_does_not_listen_on_the_loopback_address_of_ipv6(self):
        simulator = Simulator("EX9042D", "--port", "tcp:0")
        self.addCleanup(simulator.close)
        with self.assertRaises(OSError):
            socket.create_connection(("::1", simulator.port), HANG)


class Broken(unittest.TestCase):
    def test_a_capture_that_fails_while_a_page_holds_an_input_ends_the_program_with_status_1(self):
        with tempfile.TemporaryDirectory() as folder:
            fifo = os.path.join(folder, "capture")
            os.mkfifo(fifo)
            reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
            os.set_blocking(reader, True)
            replied = threading.Event()

            def drain():  # a full pipe would stop the line, and the page would get no reply
                while not replied.is_set():
                    os.read(reader, 65536)
                os.close(reader)

            # Every frame is written to the capture, so the write fails in a timer of the line, in a command of the
            # page, or in the command that undoes it.
            simulator = Simulator("EX9055D", "--port", "tcp:0", "--capture", fifo, "--timing", "instant",
                                  "--speed", "10", "--fault", "foreign-traffic 2430314D0D every 10ms",
                                  stderr=subprocess.PIPE)
            self.addCleanup(simulator.close)
            page = Page(simulator.port)
            self.addCleanup(page.close)
            drains = threading.Thread(target=drain, daemon=True)
            drains.start()
            page.say("1 input 3 on", undo="1 input 3 off")
            page.until(lambda message: "reply" in message)
            replied.set()
            drains.join()
            error = simulator.process.stderr.read()
            self.assertEqual(simulator.process.wait(HANG), 1, error)
            self.assertRegex(error, r"\Aex9000-sim: --capture: \S+: cannot be written: Broken pipe[^\n]*\n\Z")


class Slow(unittest.TestCase):
    def test_a_page_that_does_not_read_delays_no_other_page_and_later_gets_the_state(self):
        simulator = Simulator("EX9042D-M@01", "EX9052D-M@02", "--port", "tcp:0", "--timing", "instant")
        self.addCleanup(simulator.close)
        master = Master(simulator.lines[0])
        self.addCleanup(master.close)
        slow, page = Page(simulator.port, receives=2048), Page(simulator.port)
        for each in slow, page:
            self.addCleanup(each.close)
            self.assertEqual(each.status, 101)
        told = []  # the line time in us in each state that `page` has received
        reads = threading.Thread(target=page.until, args=(lambda message: told.extend(times_of(message))
                                                          or message.get("reply"),))
        reads.start()
        # `full` is the number of bytes in the send queue to the slow page. `seen` is the length of `told` at the last
        # change of `full`.
        full, seen = 0, 0
        while len(told) < seen + LOOKS:
            self.assertTrue(reads.is_alive())
            slow.show_life()
            for _ in range(200):
                master.ask("020200000008", 6)
            if (piled_up := unsent(simulator.port, slow.connection)) != full:
                full, seen = piled_up, len(told)
        self.assertGreater(full, 100000)
        page.say("2 input 0 on")
        reads.join(HANG)
        self.assertFalse(reads.is_alive())
        times, inputs = [], None
        while inputs != 1:
            state = slow.until(lambda message: message.get("state"))["state"]
            times += times_of({"state": state})
            inputs = next((each["plate"]["inputs"] for each in state["modules"]
                           if each["module"] == 1 and "plate" in each), inputs)
        # `most` is the largest number of states for `page` between two successive states for the slow page.
        most = max(sum(before < each < after for each in told) for before, after in zip(times, times[1:]))
        self.assertGreaterEqual(most, LOOKS - 1)


def tcp_sockets():
    """Returns the lines of the kernel's list of TCP sockets with IPv4. Each line describes one socket."""
    return pathlib.Path("/proc/net/tcp").read_text(encoding="ascii").splitlines()[1:]


def unsent(port, connection):
    """Returns the number of bytes in the send queue of the simulator's socket at the other end of `connection`. These
    bytes are not acknowledged yet."""
    ends = [f"0100007F:{each:04X}" for each in (port, connection.getsockname()[1])]
    for line in tcp_sockets():
        columns = line.split()
        if columns[1:3] == ends:
            return int(columns[4].split(":")[0], 16)
    raise AssertionError("/live: the server has closed the connection; expected an open connection")


def times_of(message):
    return [message["state"]["lines"][0]["now"]] if message.get("state") else []


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=HANG, check=False)


if __name__ == "__main__":
    unittest.main()
