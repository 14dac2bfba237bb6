from .motor import Motor
from .sonar import Sonar as _S
__all__ = ["Motor", "Sonar"]
Sonar = _S
