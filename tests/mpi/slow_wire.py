#!/usr/bin/env python3
"""Joins network interfaces as a switch does, but slowly.

    slow_wire.py MILLISECONDS MEGABITS INTERFACE...

Delays every frame by MILLISECONDS, and sends at most MEGABITS per second to each interface. The kernel's netem (tc)
does the same, but the kernels of containers and small virtual machines often lack netem.
"""
import heapq
import select
import socket
import sys
import time

EVERY_PROTOCOL, OUTGOING = 3, 4         # ETH_P_ALL, PACKET_OUTGOING
PACKET_LEVEL, OFFLOAD_HEADER = 263, 15  # SOL_PACKET, PACKET_VNET_HDR
# With an offload header, a frame has up to 64 KiB, and its checksum is not computed. Frames are forwarded unchanged.
HEADER, TARGET, SOURCE = 10, slice(10, 16), slice(16, 22)


def open_port(interface):
    port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(EVERY_PROTOCOL))
    port.setsockopt(PACKET_LEVEL, OFFLOAD_HEADER, 1)
    port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
    port.bind((interface, 0))
    return port


class Wire:
    def __init__(self, delay, bytes_per_second, interfaces):
        self.delay, self.bytes_per_second = delay, bytes_per_second
        self.busy_until = {open_port(interface): 0.0 for interface in interfaces}
        self.home = {}        # hardware address -> port that received frames from this address
        self.under_way = []   # heap of (arrival time, number, port, frame)
        self.frames = 0

    def take(self, port):
        frame, (_, _, kind, *_) = port.recvfrom(1 << 17)
        if kind == OUTGOING:
            return
        self.home[frame[SOURCE]] = port
        target = self.home.get(frame[TARGET])
        for out in [target] if target else [other for other in self.busy_until if other is not port]:
            begin = max(self.busy_until[out], time.monotonic())
            self.busy_until[out] = begin + (len(frame) - HEADER) / self.bytes_per_second
            self.frames += 1
            heapq.heappush(self.under_way, (self.busy_until[out] + self.delay, self.frames, out, frame))

    def run(self):
        while True:
            wait = max(0.0, self.under_way[0][0] - time.monotonic()) if self.under_way else None
            for port in select.select(list(self.busy_until), [], [], wait)[0]:
                try:
                    self.take(port)
                except OSError:  # the interface went down; the kernel reports this once
                    pass
            while self.under_way and self.under_way[0][0] <= time.monotonic():
                _, _, port, frame = heapq.heappop(self.under_way)
                try:
                    port.send(frame)
                except OSError:  # the frame is lost
                    pass


milliseconds, megabits = float(sys.argv[1]), float(sys.argv[2])
Wire(milliseconds * 1e-3, megabits * 1e6 / 8, sys.argv[3:]).run()
