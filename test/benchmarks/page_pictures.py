"""Take the pictures of the pages for README and docs, of a real robot, explainer and study.

    python test/benchmarks/page_pictures.py docs/figures

writes operator_page.png, operator_page_dark.png and study.png. Needs ROS 2, chromium and
playwright.
"""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / 'helpers'))

import rclpy
from browser import CHROMIUM, SCREENS, served
from patience import eventually
from playwright.sync_api import Browser, sync_playwright
from ros_peer import USER_MODEL, Peer, last_diagnostic, running
from study_client import STUDY

_NAMESPACE = '/robot'  # as the page shows it
_PAGE = ['-m', 'mirror_explainer.web.operator.operator_page', '--port', '0', '--ros-args']


def main(folder: Path) -> None:
    """Write the pictures into the folder."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=['--no-sandbox'])
        _operator_page(browser, folder)
        _study(browser, folder)
        browser.close()


def _operator_page(browser: Browser, folder: Path) -> None:
    """Take the answer about a plan that has just begun, light and dark."""
    rclpy.init()
    peer = Peer(_NAMESPACE)
    width, height = SCREENS['desktop']
    with (
        tempfile.TemporaryDirectory() as logs,
        running('explainer_node', _NAMESPACE, Path(logs), user_model_file=USER_MODEL),
        served([*_PAGE, '-r', f'__ns:={_NAMESPACE}']) as server,
    ):
        peer.publish_warehouse()
        peer.answer()
        eventually(lambda: last_diagnostic(peer).get('seconds planning'), 'the end of planning')
        for scheme, name in (('light', 'operator_page'), ('dark', 'operator_page_dark')):
            page = browser.new_page(
                viewport={'width': width, 'height': height}, color_scheme=scheme
            )
            page.goto(server.url)
            page.get_by_role('button', name='What are you up to?').click()
            page.locator('#status', has_text='Ready').wait_for()
            page.locator('#said li').first.wait_for()
            page.mouse.move(0, 0)
            bottom = page.locator('#timeline').bounding_box()
            clip = {'x': 0, 'y': 0, 'width': width, 'height': bottom['y'] + bottom['height'] + 12}
            page.screenshot(path=folder / f'{name}.png', clip=clip)
    peer.close()
    rclpy.try_shutdown()


def _study(browser: Browser, folder: Path) -> None:
    """Take the fourth step of the practice."""
    with tempfile.TemporaryDirectory() as kept:
        database = ['--database', f'{kept}/study.sqlite3', '--scenarios', '3']
        with served([*STUDY, 'serve', *database, '--port', '0']) as server:
            page = browser.new_page(viewport={'width': 1100, 'height': 700})
            page.goto(server.url)
            page.get_by_label('I have read this').check()
            page.get_by_role('button', name='Begin').click()
            page.get_by_role('button', name='Start').click()
            for _ in range(3):
                page.get_by_label("I don't know yet").check()
                with page.expect_navigation():
                    page.get_by_role('button', name='Answer').click()
            page.screenshot(path=folder / 'study.png')


if __name__ == '__main__':
    main(Path(sys.argv[1]))
