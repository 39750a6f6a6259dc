"""Tests that the picture of the panel in the documents shows the texts of the present page. The test does not compare
pixels, because fonts differ between machines."""

import unittest

from panel_page import Panel
from showcase import PICTURE, SIZE, prepare, texts_in


class Screenshot(Panel):
    def test_the_picture_in_the_documents_shows_the_present_texts(self):
        self.browser.size(*SIZE)
        simulator = self.show("EX9042D-M@01", "EX9052D-M@02")
        self.assertEqual(prepare(self.browser, simulator), texts_in(PICTURE.read_bytes()),
                         f"{PICTURE} is out of date; run tests/panel/screenshot and look at the result")


if __name__ == "__main__":
    unittest.main()
