// Lanes of the time line for the joints in contact, in the colours of their sides.

import { CONTACT_COLOUR } from './actor.js';
import { PRINT_COLOURS } from './prints.js';

// What all names begin with, up to its last separator: "mixamorig:", "CC_Base_".
function commonStart(names) {
  let common = names[0] ?? '';
  for (const name of names) {
    while (!name.startsWith(common)) common = common.slice(0, -1);
  }
  return common.match(/^.*[:_.|]/)?.[0].length ?? 0;
}

// `file`: to be named beside the joints, or empty.
export function sideLanes(actor, file) {
  const { left = [], right = [] } = actor.item;
  const start = commonStart(actor.names.filter((_, joint) => !actor.motion?.endSites.has(joint)));
  const joints = [...new Set(actor.contacts.map(({ joint }) => joint))].sort((a, b) => a - b);
  return joints.map((joint) => ({
    name: `${actor.names[joint].slice(start)}${file && ` · ${file}`}`,
    colour: left.includes(joint) ? PRINT_COLOURS.left : right.includes(joint) ? PRINT_COLOURS.right : CONTACT_COLOUR,
    bars: actor.contacts.filter((contact) => contact.joint === joint).map(({ start, end }) => [start, end]),
  }));
}
