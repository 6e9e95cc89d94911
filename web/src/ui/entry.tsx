import { useState } from "preact/hooks";

interface Props {
  value: string;
  /** Takes what was typed, once the field is left or Enter is pressed. */
  commit: (text: string) => void;
  label?: string;
  placeholder?: string;
  pattern?: string;
  title?: string;
  decimal?: boolean;
  required?: boolean;
}

/** A field that keeps what is typed until it is left: the page is drawn anew meanwhile. */
export function Entry({ value, commit, label, placeholder, pattern, title, decimal, required }: Props) {
  const [text, setText] = useState<string | null>(null);
  const done = () => {
    if (text !== null && text !== value) commit(text);
    setText(null);
  };
  return (
    <input class="field" value={text ?? value} aria-label={label} placeholder={placeholder}
      pattern={pattern} title={title} required={required} inputMode={decimal ? "decimal" : "text"}
      onInput={(event) => setText(event.currentTarget.value)} onBlur={done}
      onKeyDown={(event) => {
        if (event.key === "Enter") done();
        else if (event.key === "Escape" && text !== null) {
          event.stopPropagation();
          setText(null);
        }
      }} />
  );
}
