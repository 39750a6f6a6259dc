"""A client of the panel's server, over HTTP and WebSocket. Unlike a browser, the client can send any bytes."""

import base64
import json
import os
import socket
import struct

from simulator import HANG


def open_socket(port, receives=None):
    """Opens a connection. `receives` is the size of the receive buffer in bytes; None means the default."""
    connection = socket.socket()
    connection.settimeout(HANG)
    if receives:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receives)
    connection.connect(("127.0.0.1", port))
    return connection


def request(port, target="/", method="GET", host=None, headers=()):
    lines = [f"{method} {target} HTTP/1.1"]
    if host is not False:
        lines.append(f"Host: {host or f'127.0.0.1:{port}'}")
    return ("\r\n".join([*lines, *headers]) + "\r\n\r\n").encode()


def upgrade(port, origin="ours", headers=(), **others):
    key = base64.b64encode(os.urandom(16)).decode()
    headers = ["Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}",
               *headers]
    if origin:
        headers.append(f"Origin: {f'http://127.0.0.1:{port}' if origin == 'ours' else origin}")
    return request(port, "/live", headers=headers, **others)


def all_of(connection):
    """Returns all bytes that arrive until the other side closes or resets the connection."""
    answer = b""
    try:
        while piece := connection.recv(65536):
            answer += piece
    except ConnectionResetError:
        pass
    return answer


def ask(port, data):
    with open_socket(port) as connection:
        connection.sendall(data)
        return all_of(connection)


def status(answer):
    return int(answer.split()[1]) if answer else None


class Page:
    """The client's side of one connection to the WebSocket /live."""

    def __init__(self, port, receives=None):
        self.closed_with = None
        self.connection = open_socket(port, receives)
        self.connection.sendall(upgrade(port))
        self._stream = self.connection.makefile("rb")
        self.status = status(self._stream.readline())
        while self._stream.readline().strip():
            pass

    def close(self):
        self._stream.close()
        self.connection.close()

    def say(self, command, number=1, **more):
        """Sends a command without waiting for the reply."""
        self.send(json.dumps({"id": number, "do": command, **more}))

    def send(self, text, opcode=1):
        data = text if isinstance(text, bytes) else text.encode()
        size = struct.pack("!B", 0x80 | len(data)) if len(data) < 126 else struct.pack("!BH", 0xFE, len(data))
        self.connection.sendall(bytes([0x80 | opcode]) + size + bytes(4) + data)

    def show_life(self, data=b""):
        """Sends a pong, as a browser does after a ping. The server disconnects a page that sends nothing for 20 s."""
        self.send(data, opcode=10)

    def next(self):
        """Returns the next message, or None if the connection was closed."""
        while True:
            head = self._stream.read(2)
            if len(head) < 2:
                return None
            size = head[1]
            if size == 126:
                size = struct.unpack("!H", self._stream.read(2))[0]
            elif size == 127:
                size = struct.unpack("!Q", self._stream.read(8))[0]
            data = self._stream.read(size)
            if head[0] & 0xF == 9:
                self.show_life(data)
            if head[0] & 0xF == 8:
                self.closed_with = struct.unpack("!H", data[:2])[0] if data else None
                return None
            if head[0] & 0xF == 1:
                return json.loads(data)

    def until(self, holds):
        """Returns the next message for which `holds` is true. Raises AssertionError if the connection is closed before
        such a message arrives."""
        while (message := self.next()) is not None:
            if holds(message):
                return message
        raise AssertionError("/live: the server has closed the connection; expected another message")

    def tell(self, command, number=1):
        self.say(command, number)
        return self.until(lambda message: message.get("reply", {}).get("id") == number)["reply"]
