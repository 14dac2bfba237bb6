from common import *

LIMIT = 0.5
