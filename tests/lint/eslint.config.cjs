// ESLint rules for the panel's page and the JavaScript of the tests. tests/lint-scripts sets NODE_PATH for `require`.
"use strict";
const js = require("@eslint/js");

// Only the globals that the code uses. The full set of a browser contains `name`, `event` and `top`, which would hide a
// missing declaration.
const known = (...names) => Object.fromEntries(names.map((name) => [name, "readonly"]));
const BROWSER = known("ResizeObserver", "WebSocket", "clearTimeout", "devicePixelRatio", "document", "fetch",
  "getComputedStyle", "location", "matchMedia", "performance", "requestAnimationFrame", "setTimeout");
const NODE = known("Buffer", "__dirname", "console", "process");

module.exports = [
  js.configs.recommended,
  { files: ["sim/front_ends/panel/page/*.js"], languageOptions: { sourceType: "module", globals: BROWSER } },
  { files: ["tests/**/*.js", "tests/**/*.cjs"], languageOptions: { sourceType: "commonjs", globals: NODE } },
  {
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "array-callback-return": "error",
      "comma-dangle": ["error", "always-multiline"],
      "consistent-return": "error",
      "eol-last": "error",
      eqeqeq: "error",
      indent: ["error", 2],
      "max-len": ["error", 120],
      "no-else-return": "error",
      "no-eval": "error",
      "no-implicit-coercion": "error",
      "no-loop-func": "error",
      "no-param-reassign": "error",
      "no-return-assign": "error",
      "no-self-compare": "error",
      "no-shadow": ["error", { builtinGlobals: true }],
      "no-throw-literal": "error",
      "no-trailing-spaces": "error",
      "no-unreachable-loop": "error",
      "no-unused-expressions": "error",
      "no-use-before-define": ["error", { functions: false, variables: false }],
      "no-useless-assignment": "error",
      "no-useless-return": "error",
      "no-var": "error",
      "prefer-const": "error",
      quotes: ["error", "double", { avoidEscape: true }],
      radix: "error",
      semi: "error",
      strict: ["error", "global"],
    },
  },
];
