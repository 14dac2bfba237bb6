import rclpy
from nav_msgs.srv import GetMap
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
server, client_node = rclpy.create_node("server"), rclpy.create_node("asker")


def serve(request, response):
    say("asked", type(request).__name__)
    response.map.header.frame_id = "map"
    return response


server.create_service(GetMap, "ask", serve)
client = client_node.create_client(GetMap, "ask")
say(client.wait_for_service(timeout_sec=1.0))
executor = SingleThreadedExecutor()
executor.add_node(server)
executor.add_node(client_node)
future = client.call_async(GetMap.Request())
say(future.done(), future.cancelled())
executor.spin_until_future_complete(future, timeout_sec=1.0)
say(future.done(), future.result().map.header.frame_id, future.exception())
nobody = client_node.create_client(GetMap, "nobody")
say(nobody.wait_for_service(timeout_sec=0.3), nobody.service_is_ready())
waiting = nobody.call_async(GetMap.Request())
executor.spin_until_future_complete(waiting, timeout_sec=0.2)
say(waiting.done())
try:
    client.call_async("text")
except Exception as error:
    say(type(error).__name__)
