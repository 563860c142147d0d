#!/usr/bin/python3
"""Attacks on a server by a client that was written from octopair.proto alone. After each attack, the server must still answer
authenticated clients promptly and right.

    attacks_test.py --program PATH [CLASS[.TEST]...]
"""
import unittest

import settings
from access_attacks import Certificates, Jobs, Scenes, Tokens, TokensAndCertificates
from connection_attacks import FewOpenFiles, Metrics, Strangers
from flood_attacks import Floods, UnixFloods
from message_attacks import Large, Malformed, Senseless
from sharing_attacks import Sharing
from upload_attacks import DamagedState, DetachedJobs, Stalls, Uploads

if __name__ == "__main__":
    unittest.main(argv=settings.parse(settings.parser(__doc__))[1])
