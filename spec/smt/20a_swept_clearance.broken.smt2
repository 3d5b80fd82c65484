; BROKEN     Twin of 20a_swept_clearance.smt2: who is beyond the far end is not looked at.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const x Real)        ; where somebody is, across
(declare-const z Real)        ; and ahead
(declare-const s Real)        ; sine of the way's direction
(declare-const k Real)        ; cosine of the way's direction
(declare-const L Real)        ; its length
(declare-const c Real)        ; clearance to be kept
(declare-const t Real)        ; how far along a point of the way is
(define-fun along () Real (+ (* x s) (* z k)))
(define-fun aside () Real (- (* x k) (* z s)))
; Assumptions
(assert (= (+ (* s s) (* k k)) 1))
(assert (>= c 0))
(assert (<= 0 t L))
(assert (=> (<= along 0) (>= (+ (* x x) (* z z)) (* c c))))
(assert (=> (and (< 0 along) (< along L)) (>= (* aside aside) (* c c))))
(assert (=> (>= along L) (>= c 0)))                        ; BROKEN: no distance

; Conclusion, negated
(assert (not (>= (+ (* (- x (* s t)) (- x (* s t))) (* (- z (* k t)) (- z (* k t)))) (* c c))))
(check-sat)
