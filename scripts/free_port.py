"""Ports for servers that several runs side by side start."""
import random
import socket

PORTS = range(20000, 32000)  # below those that systems give to outgoing connections, one of which could come in between
TRIES = 1000


def free_port():
    """A port at which nothing listens."""
    for _ in range(TRIES):
        port = random.SystemRandom().choice(PORTS)
        with socket.socket() as probe:
            try:
                probe.bind(("", port))
                return port
            except OSError:
                continue
    raise RuntimeError("no port of %d to %d is free" % (PORTS[0], PORTS[-1]))


if __name__ == "__main__":
    print(free_port())
