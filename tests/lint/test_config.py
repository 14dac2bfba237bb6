import os
from pathlib import Path

import pytest

from tarl_lint.baseline import load
from tarl_lint.errors import BaselineError, ConfigError
from tarl_lint.settings.config import Config, Options, resolve
from tarl_lint.settings.schema import Wrapper
from tarl_lint.settings.wrappers import facts


def test_the_default_configuration_enables_every_rule_and_excludes_nothing():
    config = Config()
    assert config.enabled("TARL101")
    assert config.enabled("TARL201")
    assert config.exclude == ()
    assert config.fail_on == "explicit"


@pytest.mark.parametrize(
    ("select", "ignore", "code", "wanted"),
    [
        (("TARL1",), (), "TARL101", True),
        (("TARL1",), (), "TARL201", False),
        ((), ("TARL102",), "TARL102", False),
        (("TARL1",), ("TARL102",), "TARL102", False),
        (("TARL1",), ("TARL102",), "TARL101", True),
    ],
)
def test_codes_are_selected_and_ignored_by_prefix(select, ignore, code, wanted):
    assert Config(select=select, ignore=ignore).enabled(code) is wanted


def test_settings_come_from_the_nearest_pyproject_with_our_table(in_directory):
    root = in_directory(
        {
            "pyproject.toml": '[tool.tarl-lint]\nselect = ["tarl1"]\nexclude = ["vendor/"]\nfail-on = "implicit"\n',
            "a/pyproject.toml": "[project]\nname = 'a'\n",
            "a/b/node.py": "",
        }
    )
    config = resolve(Options(paths=(Path("a/b/node.py"),)))
    assert config.file == root / "pyproject.toml"
    assert (config.select, config.exclude, config.fail_on) == (("TARL1",), ("vendor/",), "implicit")
    assert config.root == root
    assert dict(config.origins)["select"] == "pyproject.toml"


def test_the_command_line_overrides_the_settings_file(in_directory):
    in_directory({"pyproject.toml": '[tool.tarl-lint]\nselect = ["TARL1"]\nfail-on = "hazard"\n'})
    config = resolve(Options(select=("TARL2",)))
    assert config.select == ("TARL2",)
    assert config.fail_on == "hazard"
    assert dict(config.origins) | {"select": "command line", "fail-on": "pyproject.toml"} == dict(
        config.origins
    )


def test_settings_search_ends_at_the_repository_root(in_directory):
    root = in_directory(
        {"pyproject.toml": '[tool.tarl-lint]\nselect = ["TARL1"]\n', "repository/node.py": ""}
    )
    (root / "repository/.git").mkdir()
    config = resolve(Options(paths=(Path("repository"),)))
    assert config.file is None
    assert config.root == root / "repository"


def test_an_unknown_key_is_refused_with_a_suggestion(in_directory):
    in_directory({"pyproject.toml": '[tool.tarl-lint]\nigore = ["TARL102"]\n'})
    with pytest.raises(ConfigError, match=r"pyproject\.toml: .*no key 'igore': did you mean 'ignore'\?"):
        resolve(Options())


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("select = 'TARL101'", r"'select' .* must be a list of rule codes .* not 'TARL101'"),
        ("ignore = [1]", r"'ignore' .* must be a list of rule codes"),
        ("exclude = ['']", r"'exclude' .* must be a list of patterns"),
        ("baseline = false", r"'baseline' .* must be the name of a file"),
        ("fail-on = 'always'", r"'fail-on' .* must be one of 'never', 'hazard', 'explicit', 'implicit'"),
    ],
)
def test_value_of_the_wrong_type_names_the_expected_type(in_directory, line, complaint):
    in_directory({"pyproject.toml": f"[tool.tarl-lint]\n{line}\n"})
    with pytest.raises(ConfigError, match=complaint):
        resolve(Options())


@pytest.mark.parametrize("name", ["tarl_lint", "tarl-lnt", "tarllint"])
def test_a_misspelt_table_is_refused_with_a_suggestion(in_directory, name):
    in_directory({"pyproject.toml": f"[tool.{name}]\n[tool.other]\n"})
    with pytest.raises(ConfigError, match=rf"no \[tool\.{name}\]: did you mean \[tool\.tarl-lint\]\?"):
        resolve(Options())
    in_directory({"pyproject.toml": '[tool.tarl]\n[project]\ndependencies = ["tarl-lint"]\n'})
    assert resolve(Options()).file is None


def test_gitignore_escapes_are_distinguished_from_windows_backslashes(in_directory):
    assert settings(in_directory, r"exclude = ['a\ b', '\#x', '\*']").exclude == (r"a\ b", r"\#x", r"\*")


def test_a_byte_order_mark_before_the_settings_is_ignored(in_directory):
    in_directory({"pyproject.toml": "\ufeff[tool.tarl-lint]\r\ntf2 = true\r\n"})
    assert resolve(Options()).tf2


def test_settings_file_has_its_keys_at_the_top_level(in_directory):
    in_directory({"lint.toml": 'ignore = ["TARL102"]\n'})
    assert resolve(Options(config=Path("lint.toml"))).ignore == ("TARL102",)


def test_a_named_pyproject_without_our_table_is_refused(in_directory):
    in_directory({"pyproject.toml": "[project]\nname = 'x'\n"})
    with pytest.raises(ConfigError, match=r"pyproject\.toml has no \[tool\.tarl-lint\] table"):
        resolve(Options(config=Path("pyproject.toml")))


def test_error_names_the_invalid_settings_file(in_directory):
    in_directory({"bad.toml": "select = [", "pyproject.toml": "tool.tarl-lint = 3"})
    with pytest.raises(ConfigError, match=r"missing\.toml cannot be read: No such file"):
        resolve(Options(config=Path("missing.toml")))
    with pytest.raises(ConfigError, match=r"bad\.toml is not valid TOML"):
        resolve(Options(config=Path("bad.toml")))
    with pytest.raises(ConfigError, match=r"tool\.tarl-lint must be a table"):
        resolve(Options())


def test_baseline_beside_the_settings_is_used(in_directory):
    root = in_directory({"pyproject.toml": "[tool.tarl-lint]\n", "src/node.py": ""})
    assert resolve(Options(paths=(Path("src"),))).baseline is None
    (root / "tarl-flows.json").write_text("{}")
    assert resolve(Options(paths=(Path("src"),))).baseline == root / "tarl-flows.json"
    assert resolve(Options(paths=(Path("src"),), no_baseline=True)).baseline is None


def test_named_baseline_must_exist_unless_written(in_directory):
    root = in_directory({"pyproject.toml": '[tool.tarl-lint]\nbaseline = "ci/flows.json"\n'})
    for options in (Options(), Options(write_baseline=True)):
        assert resolve(options).baseline == root / "ci/flows.json"
    with pytest.raises(
        BaselineError, match=r"ci/flows\.json does not exist: create it with --write-baseline"
    ):
        load(root / "ci/flows.json")


def settings(in_directory, text: str) -> Config:
    in_directory({"pyproject.toml": f"[tool.tarl-lint]\n{text}\n"})
    return resolve(Options())


def test_functions_in_settings_have_qualified_names(in_directory):
    config = settings(
        in_directory, 'sources = ["bus.listen"]\nsinks = ["robot.bus.Bus.send"]\nsanitizers = []'
    )
    assert (config.sources, config.sinks) == (("bus.listen",), ("robot.bus.Bus.send",))
    assert config.named == {"bus.listen", "robot.bus.Bus.send"}


def test_topics_are_renamed_by_the_setting_remaps(in_directory):
    config = settings(in_directory, 'tf2 = true\nremaps = {"/scan" = "/front/scan"}')
    assert config.tf2
    assert config.launched == {"scan": "/front/scan"}


def test_wrappers_declare_their_model_and_argument_positions(in_directory):
    config = settings(
        in_directory,
        '[tool.tarl-lint.wrappers]\n"bus.listen" = "rospy.Subscriber"\n'
        '"bus.talk" = {like = "rospy.Publisher", topic = 1, type = "kind"}',
    )
    assert config.wrappers == (
        Wrapper("bus.listen", "rospy.Subscriber"),
        Wrapper("bus.talk", "rospy.Publisher", topic=1, type="kind"),
    )


def test_per_file_ignores_are_patterns_with_codes(in_directory):
    config = settings(in_directory, 'per-file-ignores = {"tests/" = ["tarl1"], "*_demo.py" = ["TARL102"]}')
    assert config.per_file_ignores == (("tests/", ("TARL1",)), ("*_demo.py", ("TARL102",)))
    typed = resolve(Options(per_file_ignores=(("a.py", ("TARL2",)),)))
    assert typed.per_file_ignores == (("a.py", ("TARL2",)),)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('sources = ["listen"]', r"'sources' .* must be a list of qualified names .* not \['listen'\]"),
        ('sinks = "bus.send"', r"'sinks' .* must be a list of qualified names"),
        ('sanitizers = ["bus.send()"]', r"'sanitizers' .* must be a list of qualified names"),
        ('remaps = ["scan"]', r"'remaps' .* must be a table from topics"),
        ('tf2 = "yes"', r"'tf2' .* must be true or false, not 'yes'"),
        ('wrappers = ["bus.listen"]', r"'wrappers' .* must be a table"),
        ('wrappers = {"listen" = "rospy.Subscriber"}', r"'wrappers' .* must be a table"),
        ('wrappers = {"bus.listen" = {topic = 1}}', r"'wrappers' .* must be a table"),
        (
            'wrappers = {"bus.listen" = {like = "rospy.Subscriber", topik = 1}}',
            r"'wrappers' .* 'bus\.listen' has no key 'topik': its keys are callback, extra, like, topic, type\.",
        ),
        (
            'wrappers = {"bus.listen" = {like = "rospy.Subscriber", topic = -1}}',
            r"'wrappers' .* must be a table",
        ),
        (
            'wrappers = {"bus.listen" = {like = "rospy.Subscriber", topic = true}}',
            r"'wrappers' .* must be a table",
        ),
        (
            'per-file-ignores = ["tests/"]',
            r"'per-file-ignores' .* must be a table of patterns and rule codes",
        ),
        ('per-file-ignores = {"tests/" = "TARL1"}', r"'per-file-ignores' .* must be a table"),
        ('exclude = ["src\\\\vendor"]', r"'exclude' .* has backslashes: .*: 'src/vendor'"),
        (
            'per-file-ignores = {"tests\\\\" = ["TARL1"]}',
            r"'per-file-ignores' .* has backslashes: .*: 'tests/'",
        ),
        ("sorces = []", r"no key 'sorces': did you mean 'sources'\?"),
        ("per_file_ignores = {}", r"no key 'per_file_ignores': did you mean 'per-file-ignores'\?"),
    ],
)
def test_invalid_names_and_tables_are_refused(in_directory, line, complaint):
    with pytest.raises(ConfigError, match=complaint):
        settings(in_directory, line)


def test_wrapper_of_an_unknown_function_is_refused():
    with pytest.raises(
        ConfigError, match=r"'bus\.listen' .* like = 'rospy\.Subscribr', .* mean 'rospy\.Subscriber'\?"
    ):
        facts((Wrapper("bus.listen", "rospy.Subscribr"),))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_baseline_must_be_a_regular_file(in_directory, kind):
    in_directory({"pyproject.toml": "[tool.tarl-lint]\nbaseline = 'accepted'\n"})
    assert resolve(Options()).baseline == Path.cwd() / "accepted"
    if kind == "pipe":
        os.mkfifo("accepted")
    elif kind == "device":
        Path("accepted").symlink_to("/dev/zero")
    else:
        Path("accepted").mkdir()
    with pytest.raises(ConfigError, match="accepted of the settings is not a regular file: name another"):
        resolve(Options())
