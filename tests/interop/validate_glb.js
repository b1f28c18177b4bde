// The Khronos validator's word on a GLB. Usage: node validate_glb.js MODULES FILE, where MODULES has gltf-validator.
const fs = require("fs");
const path = require("path");
const validator = require(path.resolve(process.argv[2], "gltf-validator"));

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[3]))).then(({ issues }) => {
  // Ends of limbs are nodes with nothing in them, on purpose.
  const wrong = issues.messages.filter(({ severity, code }) => severity < 2 || code !== "NODE_EMPTY");
  wrong.forEach(({ code, message, pointer }) => console.error(`${code} at ${pointer}: ${message}`));
  console.log(`glb by the Khronos validator: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
  process.exit(wrong.length === 0 ? 0 : 1);
});
