"""The wrapper of this project around rospy."""

import rospy


class Bus:
    def __init__(self, namespace):
        self.namespace = namespace
        self._publishers = {}
        self._subscribers = []

    def listen(self, topic, kind, callback, **options):
        full = f"{self.namespace}/{topic}"
        self._subscribers.append(rospy.Subscriber(full, kind, self._guard(callback), **options))

    def _guard(self, callback):
        def guarded(msg):
            try:
                callback(msg)
            except Exception as error:
                rospy.logerr("%s", error)

        return guarded

    def send(self, topic, kind, **fields):
        if topic not in self._publishers:
            self._publishers[topic] = rospy.Publisher(f"{self.namespace}/{topic}", kind, queue_size=1)
        self._publishers[topic].publish(kind(**fields))  # sink level name


class Topic:
    """A value that is read and written as an attribute."""

    def __init__(self, bus, name, kind):
        self.bus, self.name, self.kind = bus, name, kind
        self.last = None
        bus.listen(name, kind, self._keep)  # source stored

    def _keep(self, msg):
        self.last = msg.data
