"""A log record reaches the handlers of its logger and of the parent loggers, if its level is high enough."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

NODE = """\
import logging
import rospy
from std_msgs.msg import Float64, String
logger = logging.getLogger("tool.pump")
class Topic(logging.Handler):
    def __init__(self, topic, level=logging.WARNING):
        logging.Handler.__init__(self, level)
        self.publisher = rospy.Publisher(topic, String, queue_size=1)
    def emit(self, record):
        self.publisher.publish(EMITTED)  # MARK
def on(msg):
    LOG
logging.getLogger("WHERE").addHandler(Topic("log"))
rospy.Subscriber("in", Float64, on)
rospy.spin()
"""
# what is logged, what the handler publishes, the logger of the handler, and the kind of the flow
PROGRAMS = """\
### a message with an argument
logger.warning("bad %s", msg.data)|record.getMessage()|tool.pump|data
### the root logger
logger.error(f"bad {msg.data}")|self.format(record)||data
### a logger above
logger.critical("bad %s", msg.data)|record.msg|tool|data
### another logger
logger.warning("bad %s", msg.data)|record.getMessage()|other|clean
### a level below that of the handler
logger.info("bad %s", msg.data)|record.getMessage()|tool.pump|clean
### a level of which only the base class is told
logger.info("bad %s", msg.data)|record.getMessage()|tool.pump|clean|super().__init__(level)
### a level that is set later
logger.info("bad %s", msg.data)|record.getMessage()|tool.pump|data|super().__init__(); self.setLevel(logging.INFO)
### a constant message that a condition decides about
logger.warning("bad" if msg.data > 1.0 else "good")|record.getMessage()|tool.pump|control
### the name of a logger
logger.warning("bad %s", msg.data)|record.name|tool.pump|clean
### no data
logger.warning("received")|record.getMessage()|tool.pump|clean
"""
CASES = sections(PROGRAMS)


@pytest.mark.parametrize("title", CASES)
def test_records_reach_emit_of_the_handlers(title):
    log, emitted, where, mark, *made = CASES[title].strip().split("|")
    text = NODE.replace("LOG", log).replace("EMITTED", emitted).replace("WHERE", where).replace("MARK", mark)
    for code in made:
        text = text.replace("logging.Handler.__init__(self, level)", code)
    assert differing(text) == {}
