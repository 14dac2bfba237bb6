from dataclasses import replace

from tarl_lint.model import Flow
from tarl_lint.report.line import View, columns, plain
from tarl_lint.report.overview import MANY, overview


def flow(example, source: str, sink: str, kind: str = "explicit", line: int = 1) -> Flow:
    made = example.flow(kind, source)
    return replace(made, sink=replace(made.sink, topics=(sink,), span=replace(made.sink.span, line=line)))


def shown(flows, width: int = 0) -> list[str]:
    return [plain(line) for line in overview(flows, View(width=width))]


def test_each_published_topic_lists_its_data_and_its_conditions(example):
    flows = [flow(example, "odom", "cmd_vel", line=n) for n in range(MANY)]
    flows += [flow(example, "scan", "cmd_vel", "implicit"), flow(example, "odom", "cmd_vel", "implicit")]
    flows += [flow(example, "goal", "path"), flow(example, "estop", "led", "implicit")]
    assert shown(flows) == [
        "Published topics, and the topics that reach them:",
        "  cmd_vel  ● data of    odom",
        "           ◆ decided by scan",
        "  led      ◆ decided by estop",
        "  path     ● data of    goal",
        "",
    ]


def test_long_lists_are_wrapped_to_the_terminal(example):
    flows = [flow(example, f"sensors/number_{n}", "cmd_vel", line=n) for n in range(12)]
    lines = shown(flows, width=80)
    assert max(map(columns, lines)) <= 80
    assert " ".join(" ".join(lines).split()).count("sensors/number_") == 12
    assert len(lines) > 3


def test_short_reports_have_no_overview(example):
    assert shown([flow(example, "odom", "cmd_vel", line=n) for n in range(MANY - 1)]) == []
