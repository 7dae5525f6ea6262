// SPDX-License-Identifier: Apache-2.0

/**
 * A name without what the branch above it says, or a namespace with what is in it.
 * @typedef {{name: string, label: string, below?: Node[]}} Node
 */

/**
 * Return names of ROS as a tree: what shares a namespace with others stands in a branch.
 * @param {string[]} names sorted
 * @param {string} [above] the namespace that all of them are in
 * @returns {Node[]}
 */
export function treeOf(names, above = "") {
  const groups = new Map(); // namespace, or the name of what is in none -> names
  for (const name of names) {
    const end = name.indexOf("/", above.length + 1);
    const key = end < 0 ? `${name}/` : name.slice(0, end); // a topic may have the name of a namespace
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(name);
  }
  return [...groups].map(([key, inside]) => {
    const [name] = inside;
    if (inside.length === 1) return { name, label: name.slice(above.length) };
    const namespace = commonNamespace(inside, key);
    return { name: namespace, label: namespace.slice(above.length), below: treeOf(inside, namespace) };
  });
}

/** Return the longest namespace below *least* that all of the names are in. */
function commonNamespace([first, ...others], least) {
  const end = first.indexOf("/", least.length + 1);
  const longer = first.slice(0, end);
  if (end < 0 || !others.every((each) => each.startsWith(`${longer}/`))) return least;
  return commonNamespace([first, ...others], longer);
}
