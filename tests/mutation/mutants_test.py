"""Tests which parts of a source the rules change, and how."""

import unittest

import mutants

SOURCE = """\
#include "a.hpp"  // 1 + 1
  #define INDENTED 1 + 1
static_assert(sizeof(int) == 4, "4");
int sum(const int& a, int b) {
  if (a < b && b != 7) {
    return a + b;
  }
  store(a, "x == y");
  int c = 0;  // 2 + 2
  /* 3 + 3 */
  wide(a &&
       b);
  const char d = '4';
  c += 0x10U;
  return true ? c : -1;
}
const char* raw = R"({"lines": 3 + 4})";
"""


def changed(rule):
    return {each.of(SOURCE).splitlines()[SOURCE.count("\n", 0, each.begin)].strip() for each in rule("f", SOURCE)}


class Mutants(unittest.TestCase):
    def test_binary_operators_are_replaced(self):
        lines = changed(mutants.of_operators)
        self.assertIn("if (a <= b && b != 7) {", lines)
        self.assertIn("if (a < b || b != 7) {", lines)
        self.assertIn("if (a < b && b == 7) {", lines)
        self.assertIn("return a - b;", lines)
        self.assertIn("wide(a ||", lines)
        self.assertIn("c -= 0x10U;", lines)

    def test_comments_preprocessor_lines_strings_character_literals_and_references_do_not_change(self):
        for line in changed(mutants.of_operators) | changed(mutants.of_constants):
            self.assertNotIn("|", line.replace("||", ""))
            self.assertFalse(line.startswith("#"))
            self.assertFalse(line.startswith("const char"))
            self.assertFalse(line.startswith("/*"))
            self.assertTrue(line.endswith("// 2 + 2") or "//" not in line)
        self.assertNotIn('store(a, "x != y");', changed(mutants.of_operators))

    def test_numbers_change_by_one_and_booleans_are_inverted(self):
        lines = changed(mutants.of_constants)
        self.assertIn("c += 17U;", lines)
        self.assertIn("c += 15U;", lines)
        self.assertIn("int c = 1;  // 2 + 2", lines)
        self.assertIn("return false ? c : -1;", lines)

    def test_octal_and_binary_constants_are_read_in_their_base(self):
        mode = "const int mode = 0644;\nconst int bits = 0b101;\n"
        changed_to = {each.text for each in mutants.of_constants("f", mode)}
        self.assertEqual(changed_to, {str(0o645), str(0o643), "6", "4"})

    def test_calls_and_assignments_are_removed_but_declarations_are_not(self):
        left_out = [SOURCE[each.begin : each.end] for each in mutants.of_statements("f", SOURCE)]
        self.assertEqual(left_out, ['store(a, "x == y");', "c += 0x10U;"])

    def test_a_condition_is_negated(self):
        self.assertEqual(changed(mutants.of_branches), {"if (!(a < b && b != 7)) {"})

    def test_a_static_assert_does_not_change(self):
        for each in mutants.all_of("f", SOURCE):
            self.assertNotIn("static_assert", SOURCE[SOURCE.rfind("\n", 0, each.begin) : each.end])

    def test_files_are_taken_in_turn_and_the_seed_determines_the_order_of_all_mutants(self):
        sources = {"a": SOURCE, "b": SOURCE, "c": SOURCE}
        order = list(mutants.spread(sources, 1))
        self.assertEqual(order, list(mutants.spread(sources, 1)))
        self.assertNotEqual(order, list(mutants.spread(sources, 2)))
        self.assertEqual({each.file for each in order[:3]}, {"a", "b", "c"})
        self.assertEqual(len(order), 3 * len(list(mutants.all_of("a", SOURCE))))


if __name__ == "__main__":
    unittest.main()
