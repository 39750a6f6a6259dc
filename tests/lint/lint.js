// Usage: NODE_PATH=FOLDER node tests/lint/lint.js FILE...
// Lints JavaScript files with the library of ESLint. The package `eslint` needs 80 others for its command line.
"use strict";
const fs = require("fs");
const { Linter } = require("eslint-linter-browserify");
const config = require("./eslint.config.cjs");

const linter = new Linter({ configType: "flat" });
for (const file of process.argv.slice(2)) {
  for (const { line, column, message, ruleId } of linter.verify(fs.readFileSync(file, "utf8"), config, file)) {
    console.log(`${file}:${line}:${column}: ${message} (${ruleId})`);
    process.exitCode = 1;
  }
}
