import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future

rclpy.init()
node = rclpy.create_node("prober")
executor = SingleThreadedExecutor()
executor.add_node(node)
future = Future()
future.add_done_callback(lambda one: say("done", one.result()))
say(future.done(), future.result(), future.cancelled())


async def later():
    say("task", await future)
    return 5


task = executor.create_task(later)
timer = node.create_timer(0.1, lambda: (timer.cancel(), future.set_result(3)))
executor.spin_until_future_complete(task, timeout_sec=1.0)
say(task.done(), task.result())
failing = executor.create_task(lambda: 1 / 0)
try:
    executor.spin_once(timeout_sec=0.1)
except Exception as error:
    say(type(error).__name__)
cancelled = Future()
cancelled.cancel()
say(cancelled.cancelled(), cancelled.done())
rclpy.spin_once(node, timeout_sec=0.1)
say(node.get_clock().now().nanoseconds)
