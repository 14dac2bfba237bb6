"""Build the site.

    python -m website.build [--quick]

The script copies the pages to build/pages, from which zensical builds build/site. Warnings are errors. Once `python -m
website.build --fetch` has stored fonts and scripts in build/assets, nothing is fetched.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import tomllib

from website import assets, gallery, links, message_pages, pages, reference

HERE = Path(__file__).parent
BUILD = HERE.parent / "build"


def settings(address: str, quick: bool) -> str:
    """Return zensical's settings: website/zensical.toml plus the folders, the address and the menu of versions."""
    text = (HERE / "zensical.toml").read_text("utf-8")
    tomllib.loads(text)  # parsed only to report syntax errors with their line
    known = [
        'docs_dir = "pages"',
        'site_dir = "site"',
        *([f'site_url = "{address}"'] if address else []),
    ]
    if quick:
        text = "".join(line for line in text.splitlines(keepends=True) if '"gallery/index.md"' not in line)
    text = text.replace("[project]\n", "[project]\n" + "\n".join(known) + "\n", 1)
    text = text.replace("[project.theme]\n", '[project.theme]\ncustom_dir = "overrides"\n', 1)
    # a site with an address is published beside other versions, and has a menu to switch between them
    if address:
        text = text.replace("[project.extra]\n", '[project.extra]\nversion = { provider = "mike" }\n', 1)
    return text.replace('paths = ["."]', 'paths = [".."]', 1)


def stage(build: Path, quick: bool) -> None:
    """Copy and generate all pages below `build`."""
    staged = build / "pages"
    shutil.rmtree(staged, ignore_errors=True)
    shutil.rmtree(build / "overrides", ignore_errors=True)
    pages.stage(staged)
    message_pages.write(staged)
    reference.write(staged)
    if not quick:
        gallery.write(staged)
    shutil.copytree(HERE / "overrides", build / "overrides")
    shutil.copytree(assets.KEPT, staged / "assets", ignore=shutil.ignore_patterns(".*", "axe"))
    for name in ("style.css", "reading.js"):
        shutil.copyfile(HERE / name, staged / "assets" / name)


def build(target: Path, *, quick: bool = False, address: str = "") -> Path:
    """Build the site below `target` and return its directory; `quick` omits the gallery.

    Raise CalledProcessError on a warning, and AssetsError if a package cannot be fetched.
    """
    for package in assets.SHIPPED:
        assets.fetch(package)
    target.mkdir(parents=True, exist_ok=True)
    stage(target, quick)
    (target / "zensical.toml").write_text(settings(address, quick), "utf-8")
    program = Path(sys.executable).with_name("zensical")
    subprocess.run([program, "build", "--strict", "--clean"], cwd=target, check=True)
    return target / "site"


def main() -> None:
    """Build the site and check its links."""
    parser = argparse.ArgumentParser(description="Build the documentation site in build/site.")
    parser.add_argument("--quick", action="store_true", help="omit the gallery, which runs the examples")
    parser.add_argument(
        "--fetch", action="store_true", help="only fetch the fonts and scripts of the site and of its tests"
    )
    arguments = parser.parse_args()
    try:
        if arguments.fetch:
            for package in (*assets.SHIPPED, assets.TESTED_WITH):
                assets.fetch(package)
            return
        site = build(BUILD, quick=arguments.quick, address=os.environ.get("SITE_URL", ""))
    except (assets.AssetsError, ValueError) as problem:
        sys.exit(f"docs: {problem}")
    except subprocess.CalledProcessError as failed:
        sys.exit(failed.returncode)
    broken = links.broken(site)
    if broken:
        sys.exit("docs: broken links:\n" + "\n".join(broken))
    print(f"tarl {version('tarl')}: {site / 'index.html'}")


if __name__ == "__main__":
    main()
