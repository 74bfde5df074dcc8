"""Who may watch, who may steer, and who has the joystick.

Pages come from this server alone: a browser that says it was sent by another origin is turned away. On loopback everybody who
reaches the port may watch; elsewhere the watcher's token is needed. Steering needs the steering token everywhere. One page at a
time has the joystick; it has to be heard within its patience (PATIENCE) at least, or it has let go.
"""

import hmac
import ipaddress
import secrets
from urllib.parse import urlsplit

PATIENCE = 0.5  # [s] of wall clock without a word of who holds the joystick
LOOPBACK_NAMES = ("localhost",)


def is_loopback(host):
    if host in LOOPBACK_NAMES:
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Access:
    def __init__(self, host):
        self.host, self.is_local = host, is_loopback(host)
        self.watching, self.steering = secrets.token_urlsafe(18), secrets.token_urlsafe(18)

    def refuses(self, origin, asked_host):
        """Why a browser's request is turned away; None where it is not. `asked_host` is what its Host header says."""
        name = urlsplit(f"//{asked_host or ''}").hostname or ""
        if self.is_local and not is_loopback(name):
            return f"this desk is on loopback; it is not called '{name}'"  # a name that was bent to this address
        if origin is not None and origin != f"http://{asked_host}":
            return f"the page comes from {origin}, and this desk only serves its own"
        return None

    def may(self, token):
        """("watch", "steer") as far as a token allows."""
        def is_(own):
            return token is not None and hmac.compare_digest(str(token).encode(), own.encode())

        may_steer = is_(self.steering)
        return self.is_local or may_steer or is_(self.watching), may_steer


class Joystick:
    """Who holds it, and where it stands: what the crane gets is `wish`."""

    def __init__(self, patience=PATIENCE):
        self.patience = patience  # [s]
        self.holder, self.heard = None, 0.0
        self.request, self.stop, self.acknowledge = 0.0, False, False
        self.lost = ""  # why the last holder is none any more

    def take(self, page, now):
        """Whether the page has it now."""
        if self.holder not in (None, page):
            return False
        self.holder, self.heard, self.lost = page, now, ""
        return True

    def give_back(self, page, reason=""):
        """The lever springs back; a pressed emergency stop stays pressed until it is pulled."""
        if self.holder != page or page is None:
            return
        self.holder, self.request, self.acknowledge, self.lost = None, 0.0, False, reason

    def release_stop(self, page):
        """Whether the emergency stop is released: everybody who steers may press it, who has the joystick releases it."""
        if self.holder != page or page is None:
            return False
        self.stop = False
        return True

    def move(self, page, request, now):
        if self.holder == page:
            self.heard, self.request = now, max(-1.0, min(1.0, request))

    def expire(self, now):
        if self.holder is not None and now - self.heard > self.patience:
            self.give_back(self.holder, f"nothing was heard of the page that had the joystick for {self.patience:g} s")
