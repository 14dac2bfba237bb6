"""`sound_play.libsoundplay`: clients of a sound server, which the test's world can provide."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.actionlib.client import SimpleActionClient
from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.rospy.topics import Publisher

__all__ = ["Sound", "SoundClient"]

_ALL, _PLAY_FILE, _SAY = -1, -2, -3  # SoundRequest.sound
_STOP, _ONCE, _LOOP = 0, 1, 2  # SoundRequest.command


class Sound:
    """A sound of a client."""

    def __init__(self, client: SoundClient, snd: int, arg: str, arg2: str = "", volume: float = 1.0) -> None:
        self._request = (client, snd, arg, arg2, volume)

    def play(self, **kwargs: Any) -> None:
        """Ask the server to play the sound once."""
        self._send(_ONCE, **kwargs)

    def repeat(self, **kwargs: Any) -> None:
        """Ask the server to repeat the sound until it is stopped."""
        self._send(_LOOP, **kwargs)

    def stop(self) -> None:
        """Ask the server to stop the sound."""
        self._send(_STOP)

    def _send(self, command: int, **kwargs: Any) -> None:
        client, sound, arg, arg2, volume = self._request
        client.sendMsg(sound, command, arg, arg2, vol=volume, **kwargs)


class SoundClient:
    """Publishes `SoundRequest` on `robotsound`; a blocking client sends a goal to `sound_play` and waits for it."""

    def __init__(
        self, blocking: bool = False, sound_action: str = "sound_play", sound_topic: str = "robotsound"
    ) -> None:
        self._blocking = blocking
        self.actionclient = SimpleActionClient(
            sound_action, class_of("ros1", "sound_play/SoundRequestAction")
        )
        self.pub = Publisher(sound_topic, class_of("ros1", "sound_play/SoundRequest"), queue_size=5)

    def sendMsg(  # noqa: N802 (the library's name)
        self, snd: int, cmd: int, s: str, arg2: str = "", vol: float = 1.0, **kwargs: Any
    ) -> None:
        """Send a request. As in the library, `blocking` and `replace` are accepted as keywords."""
        message: Any = class_of("ros1", "sound_play/SoundRequest")()
        message.sound, message.command = snd, cmd
        message.volume = float(min(max(vol, 0.0), 1.0))
        message.arg, message.arg2 = s, arg2
        if not kwargs.get("blocking", self._blocking):
            self.pub.publish(message)
            return
        goal: Any = class_of("ros1", "sound_play/SoundRequestGoal")(sound_request=message)
        if self.actionclient.wait_for_server():
            self.actionclient.send_goal_and_wait(goal)

    def voiceSound(self, s: str, volume: float = 1.0) -> Sound:  # noqa: N802
        """Return the sound of a spoken text."""
        return Sound(self, _SAY, s, volume=volume)

    def waveSound(self, sound: str, volume: float = 1.0) -> Sound:  # noqa: N802
        """Return the sound of a file."""
        return Sound(self, _PLAY_FILE, sound, volume=volume)

    def builtinSound(self, id: int, volume: float = 1.0) -> Sound:  # noqa: A002, N802
        """Return a sound of the server."""
        return Sound(self, id, "", volume=volume)

    def say(self, text: str, voice: str = "", volume: float = 1.0, **kwargs: Any) -> None:
        """Say a text once."""
        self.sendMsg(_SAY, _ONCE, text, voice, volume, **kwargs)

    def repeat(self, text: str, volume: float = 1.0, **kwargs: Any) -> None:
        """Say a text until it is stopped."""
        self.sendMsg(_SAY, _LOOP, text, vol=volume, **kwargs)

    def stopSaying(self, text: str) -> None:  # noqa: N802
        """Stop saying a text."""
        self.sendMsg(_SAY, _STOP, text)

    def playWave(self, sound: str, volume: float = 1.0, **kwargs: Any) -> None:  # noqa: N802
        """Play a file once."""
        self._file(sound, "", _ONCE, volume, **kwargs)

    def startWave(self, sound: str, volume: float = 1.0, **kwargs: Any) -> None:  # noqa: N802
        """Play a file until it is stopped."""
        self._file(sound, "", _LOOP, volume, **kwargs)

    def stopWave(self, sound: str) -> None:  # noqa: N802
        """Stop playing a file."""
        self._file(sound, "", _STOP, 1.0)

    def playWaveFromPkg(self, package: str, sound: str, volume: float = 1.0, **kwargs: Any) -> None:  # noqa: N802
        """Play a file of a package once."""
        self._file(sound, package, _ONCE, volume, **kwargs)

    def startWaveFromPkg(self, package: str, sound: str, volume: float = 1.0, **kwargs: Any) -> None:  # noqa: N802
        """Play a file of a package until it is stopped."""
        self._file(sound, package, _LOOP, volume, **kwargs)

    def stopWaveFromPkg(self, sound: str, package: str) -> None:  # noqa: N802
        """Stop playing a file of a package."""
        self._file(sound, package, _STOP, 1.0)

    def play(self, sound: int, volume: float = 1.0, **kwargs: Any) -> None:
        """Play a sound of the server once."""
        self.sendMsg(sound, _ONCE, "", vol=volume, **kwargs)

    def start(self, sound: int, volume: float = 1.0, **kwargs: Any) -> None:
        """Play a sound of the server until it is stopped."""
        self.sendMsg(sound, _LOOP, "", vol=volume, **kwargs)

    def stop(self, sound: int) -> None:
        """Stop a sound of the server."""
        self.sendMsg(sound, _STOP, "")

    def stopAll(self) -> None:  # noqa: N802
        """Stop all sounds."""
        self.stop(_ALL)

    def _file(self, sound: str, package: str, command: int, volume: float, **kwargs: Any) -> None:
        self.sendMsg(_PLAY_FILE, command, sound, package, volume, **kwargs)
