from sensor_msgs.msg import Range


class Sonar:
    def __init__(self, node, topics, on_change=None):
        self.values = {}
        self.on_change = on_change
        for t in topics:
            node.create_subscription(Range, t, self._handler(t), 10)  # source sonar

    def _handler(self, topic):
        def handle(msg):
            self.values[topic] = msg.range
            if self.on_change is not None:
                self.on_change(topic, msg.range)
        return handle

    def nearest(self):
        return min(self.values.values(), default=4.0)
