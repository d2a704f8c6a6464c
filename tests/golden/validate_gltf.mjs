// Holds glTF files against the Khronos validator: any error or warning is a failure.
//
// Usage: node validate_gltf.mjs FILE|FOLDER...   (a folder: every .glb and .gltf below it)
// Exit code 0: all are clean. 1: some are not, each message printed. 2: nothing to validate, or a
// file cannot be read.

import {readdirSync, readFileSync, statSync} from 'node:fs';
import {dirname, join} from 'node:path';
import validator from 'gltf-validator';

const SEVERITY = ['error', 'warning', 'information', 'hint'];
const MAX_SHOWN = 20;

function filesBelow(path) {
  if (!statSync(path).isDirectory()) return [path];
  return readdirSync(path, {withFileTypes: true})
      .sort((a, b) => (a.name < b.name ? -1 : 1))
      .flatMap((entry) => {
        const child = join(path, entry.name);
        if (entry.isDirectory()) return entry.name === 'node_modules' ? [] : filesBelow(child);
        return /\.(glb|gltf)$/i.test(entry.name) ? [child] : [];
      });
}

async function isClean(path) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    uri: path,
    maxIssues: 0,
    // Tangents are those of the input: where it had none, loaders compute them.
    ignoredIssues: ['MESH_PRIMITIVE_GENERATED_TANGENT_SPACE'],
    externalResourceFunction: (uri) =>
        Promise.resolve(new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri))))),
  });
  const {numErrors, numWarnings, numInfos, messages} = report.issues;
  const faults = messages.filter((message) => message.severity <= 1);
  for (const fault of faults.slice(0, MAX_SHOWN)) {
    console.log(`${path}: ${SEVERITY[fault.severity]}: ${fault.message} [${fault.code}] at ${
        fault.pointer ?? fault.offset ?? ''}`);
  }
  console.log(`${path}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes`);
  return numErrors === 0 && numWarnings === 0;
}

const paths = process.argv.slice(2);
try {
  const files = paths.flatMap(filesBelow);
  if (files.length === 0) {
    console.error('validate_gltf: no glTF file given or found');
    process.exit(2);
  }
  let dirty = 0;
  for (const file of files) {
    if (!(await isClean(file))) dirty++;
  }
  console.log(`${files.length} files, ${dirty} with errors or warnings`);
  process.exit(dirty === 0 ? 0 : 1);
} catch (error) {
  console.error(`validate_gltf: ${error.message ?? error}`);
  process.exit(2);
}
