"""Take the pictures of the operator's page for the README, of a real robot and explainer.

    python test/benchmarks/page_pictures.py docs/figures

writes operator_page.png and operator_page_dark.png. Needs ROS 2, chromium and playwright.
"""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / 'helpers'))

import rclpy
from browser import CHROMIUM, SCREENS, served
from patience import eventually
from playwright.sync_api import sync_playwright
from ros_peer import USER_MODEL, Peer, last_diagnostic, new_namespace, running

_PAGE = ['-m', 'mirror_explainer.web.operator.operator_page', '--port', '0', '--ros-args']


def main(folder: Path) -> None:
    """Write the pictures into the folder."""
    rclpy.init()
    peer = Peer(new_namespace())
    namespace = peer.node.get_namespace()
    width, height = SCREENS['desktop']
    with (
        tempfile.TemporaryDirectory() as logs,
        running('explainer_node', namespace, Path(logs), user_model_file=USER_MODEL),
        served([*_PAGE, '-r', f'__ns:={namespace}']) as server,
        sync_playwright() as driver,
    ):
        peer.publish_warehouse()
        peer.answer()
        eventually(lambda: last_diagnostic(peer).get('seconds planning'), 'the end of planning')
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=['--no-sandbox'])
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
        browser.close()
    peer.close()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main(Path(sys.argv[1]))
