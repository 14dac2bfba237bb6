"""Userdata: named values that states pass on, and each state's view of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pytest_tarl.ros.smach.errors import InvalidUserCodeError


class UserData:
    """Values by key, accessible as attributes and items."""

    def __init__(self) -> None:
        self._data: dict[str, Any] = {}

    def update(self, ud: UserData) -> None:
        """Copy all values of another userdata."""
        self._data.update(ud._data)

    def extract(self, keys: Iterable[str], remapping: Mapping[str, str]) -> UserData:
        """Return the values of `keys` under their remapped names."""
        part = UserData()
        part.merge(self, keys, remapping)
        return part

    def merge(self, ud: Any, keys: Iterable[str], remapping: Mapping[str, str]) -> None:
        """Copy the values of `keys` from another userdata, under remapped names; skip keys without a value."""
        for key in keys:
            name = remapping.get(key, key)
            if key in ud:
                self[name] = ud[key]

    def keys(self) -> list[str]:
        """Return the keys."""
        return list(self._data)

    def __contains__(self, key: str) -> bool:
        return key in self._data

    def __getitem__(self, key: str) -> Any:
        return self._data[key]

    def __setitem__(self, key: str, item: Any) -> None:
        self._data[key] = item

    def __getattr__(self, name: str) -> Any:
        """Return a value. As in smach, raise KeyError if there is none. Names that start with _ are not keys."""
        if name.startswith("_"):
            raise AttributeError(name)
        return self._data[name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            self._data[name] = value


class Remapper:
    """A state's view of userdata: its own names, input keys to read, and output keys to write."""

    def __init__(
        self,
        ud: Any,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        remapping: Mapping[str, str] | None = None,
    ) -> None:
        self._ud = ud
        self._input, self._output = set(input_keys), set(output_keys)
        self._map = dict(remapping or {})

    def keys(self) -> list[str]:
        """Return the input keys with a value."""
        return [key for key in sorted(self._input) if key in self]

    def __contains__(self, key: str) -> bool:
        return key in self._input and self._map.get(key, key) in self._ud

    def __getitem__(self, key: str) -> Any:
        if key not in self._input:
            raise InvalidUserCodeError(
                f"Reading from SMACH userdata key '{key}' but the only keys that were declared as input to this state "
                f"were: {sorted(self._input)}."
            )
        return self._ud[self._map.get(key, key)]

    def __setitem__(self, key: str, value: Any) -> None:
        if key not in self._output:
            raise InvalidUserCodeError(
                f"Writing to SMACH userdata key '{key}' but the only keys that were declared as output from this state "
                f"were: {sorted(self._output)}."
            )
        self._ud[self._map.get(key, key)] = value

    def __getattr__(self, name: str) -> Any:
        """Return the value of an input key."""
        if name.startswith("_"):
            raise AttributeError(name)
        return self[name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            self[name] = value
