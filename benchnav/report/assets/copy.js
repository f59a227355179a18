// Adds a button to each element of the class "copied" that copies its text.

/** Select a text, so that the reader can copy it where a page may not. */
function select(element) {
  getSelection().selectAllChildren(element);
}

for (const text of document.querySelectorAll("pre.copied")) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Copy";
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = "Copied";
    } catch {
      select(text);
      button.textContent = "Selected: copy it with the keyboard";
    }
  });
  text.after(button);
}
