"""`PlanningSceneInterface`: objects in the planning scene, which have no effect on plans."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.missing import unsupported_name
from pytest_tarl.ros.rospy.topics import Publisher

__all__ = ["PlanningSceneInterface"]


_BOX, _SPHERE, _CYLINDER, _CONE = 1, 2, 3, 4  # shape_msgs/SolidPrimitive
_ADD: Final = 0  # moveit_msgs/CollisionObject, with 1 for REMOVE
_REMOVE: Final = 1


class PlanningSceneInterface:
    """Publishes changes on `planning_scene`, and remembers the objects."""

    def __init__(self, ns: str = "", synchronous: bool = False, service_timeout: float = 5.0) -> None:  # noqa: ARG002
        self._objects: dict[str, Any] = {}
        self._attached: dict[str, Any] = {}
        topic = f"{ns}/planning_scene" if ns else "planning_scene"
        self._publisher = Publisher(topic, class_of("ros1", "moveit_msgs/PlanningScene"), queue_size=5)

    def add_box(self, name: str, pose: Any, size: Sequence[float] = (1, 1, 1)) -> None:
        """Add a box of this size (m)."""
        self.add_object(_solid(name, pose, _BOX, size))

    def add_sphere(self, name: str, pose: Any, radius: float = 1) -> None:
        """Add a sphere."""
        self.add_object(_solid(name, pose, _SPHERE, [radius]))

    def add_cylinder(self, name: str, pose: Any, height: float, radius: float) -> None:
        """Add a cylinder."""
        self.add_object(_solid(name, pose, _CYLINDER, [height, radius]))

    def add_cone(self, name: str, pose: Any, height: float, radius: float) -> None:
        """Add a cone."""
        self.add_object(_solid(name, pose, _CONE, [height, radius]))

    def add_plane(self, name: str, pose: Any, normal: Sequence[float] = (0, 0, 1), offset: float = 0) -> None:
        """Add a plane."""
        item = _object(name, pose)
        plane: Any = class_of("ros1", "shape_msgs/Plane")()
        plane.coef = [*map(float, normal), float(offset)]
        item.planes, item.plane_poses = [plane], [pose.pose]
        self.add_object(item)

    def add_object(self, collision_object: Any) -> None:
        """Add or replace an object."""
        self._objects[collision_object.id] = collision_object
        self._change(collision_object, _ADD)

    def remove_world_object(self, name: str | None = None) -> None:
        """Remove an object, or all of them."""
        for one in [*self._objects] if name is None else [name]:
            item = self._objects.pop(one, None) or _named(one)
            self._change(item, _REMOVE)

    def attach_box(
        self,
        link: str,
        name: str,
        pose: Any = None,
        size: Sequence[float] = (1, 1, 1),
        touch_links: Sequence[str] = (),
    ) -> None:
        """Attach an object to a link; if a pose is given, add a box for it."""
        item = _solid(name, pose, _BOX, size) if pose is not None else self._objects.pop(name, _named(name))
        attached: Any = class_of("ros1", "moveit_msgs/AttachedCollisionObject")()
        attached.object, attached.link_name = item, link
        attached.touch_links = list(touch_links) or [link]
        self.attach_object(attached)

    def attach_object(self, attached_collision_object: Any) -> None:
        """Attach an object."""
        self._objects.pop(attached_collision_object.object.id, None)
        self._attached[attached_collision_object.object.id] = attached_collision_object
        self._attach(attached_collision_object)

    def remove_attached_object(self, link: str | None = None, name: str | None = None) -> None:
        """Detach the objects of a link, or the one with this name; detached objects stay in the world."""
        for key, one in [*self._attached.items()]:
            if name in (None, key) and link in (None, one.link_name):
                del self._attached[key]
                self._objects[key] = one.object
                one.object.operation = _REMOVE
                self._attach(one)

    def clear(self) -> None:
        """Remove all objects."""
        self.remove_attached_object()
        self.remove_world_object()

    def get_known_object_names(self, with_type: bool = False) -> list[str]:  # noqa: ARG002
        """Return the names of the objects that are not attached."""
        return [*self._objects]

    def get_objects(self, object_ids: Sequence[str] = ()) -> dict[str, Any]:
        """Return the objects that are not attached, by name."""
        return {name: one for name, one in self._objects.items() if not object_ids or name in object_ids}

    def get_attached_objects(self, object_ids: Sequence[str] = ()) -> dict[str, Any]:
        """Return the attached objects by name."""
        return {name: one for name, one in self._attached.items() if not object_ids or name in object_ids}

    def get_object_poses(self, object_ids: Sequence[str]) -> dict[str, Any]:
        """Return the poses of objects by name."""
        return {name: one.pose for name, one in self.get_objects(object_ids).items()}

    def __getattr__(self, name: str) -> Any:
        """Raise UnsupportedNameError for other methods."""
        if name.startswith("_"):
            raise AttributeError(name)
        raise unsupported_name(f"moveit_commander.PlanningSceneInterface.{name}")

    def _change(self, item: Any, operation: int) -> None:
        item.operation = operation
        scene = _difference()
        scene.world.collision_objects = [item]
        self._publisher.publish(scene)

    def _attach(self, attached: Any) -> None:
        scene = _difference()
        scene.robot_state.is_diff = True
        scene.robot_state.attached_collision_objects = [attached]
        self._publisher.publish(scene)


def _difference() -> Any:
    scene: Any = class_of("ros1", "moveit_msgs/PlanningScene")()
    scene.is_diff = True
    return scene


def _named(name: str) -> Any:
    item: Any = class_of("ros1", "moveit_msgs/CollisionObject")()
    item.id = name
    return item


def _object(name: str, pose: Any) -> Any:
    item = _named(name)
    item.header = pose.header
    item.pose = pose.pose
    return item


def _solid(name: str, pose: Any, kind: int, size: Sequence[float]) -> Any:
    item = _object(name, pose)
    solid: Any = class_of("ros1", "shape_msgs/SolidPrimitive")()
    solid.type, solid.dimensions = kind, [float(one) for one in size]
    item.primitives, item.primitive_poses = [solid], [class_of("ros1", "geometry_msgs/Pose")()]
    item.primitive_poses[0].orientation.w = 1.0
    return item
